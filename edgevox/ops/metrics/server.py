"""Serves metrics over HTTP, as Prometheus asks for them: GET /metrics."""

from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4

from edgevox.ops.http_server import HttpServer, Page
from edgevox.ops.metrics.registry import Registry


class MetricsServer(HttpServer):
    """Raises `InvalidValue` where it cannot listen."""

    def __init__(self, registry: Registry, host: str, port: int) -> None:
        pages = {"/metrics": lambda: Page(registry.text(), CONTENT_TYPE_PLAIN_0_0_4)}
        super().__init__(pages, host, port, setting="metrics_port", name="edgevox-metrics")
