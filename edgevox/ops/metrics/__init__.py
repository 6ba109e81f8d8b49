"""What whoever runs robots for years counts and measures, as Prometheus reads it.

`metric_table` declares every metric once; `registry` counts events of the bus, reads what is
counted elsewhere when somebody asks, and answers. Imports core, ops.http_server and
prometheus-client, nothing else; nothing here is imported unless metrics are on.
"""

from edgevox.ops.metrics.registry import MetricsServer, Registry, observe

__all__ = ["MetricsServer", "Registry", "observe"]
