"""What whoever runs robots for years counts and measures, as Prometheus reads it.

`metric_table` declares every metric once. Events come over the bus (`bus_counter`), what is counted
elsewhere is read when somebody asks (`registry`), and `server` answers. Imports core,
ops.http_server and prometheus-client, nothing else; nothing here is imported unless metrics are on.
"""

from edgevox.ops.metrics.bus_counter import observe
from edgevox.ops.metrics.registry import MetricsServer, Registry

__all__ = ["MetricsServer", "Registry", "observe"]
