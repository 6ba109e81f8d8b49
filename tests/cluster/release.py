"""A release of the chart on a cluster, as the tests of both put it there and look at it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from control_plane import Cluster
from waiting import wait_until

CHART = Path(__file__).resolve().parents[2] / "helm" / "edgevox"
RELEASE = "app.kubernetes.io/instance=fleet"
KINDS = "statefulsets,pods,services,configmaps,networkpolicies,poddisruptionbudgets,secrets"


class Release:
    """A release in a namespace of its own, which holds to Pod Security's "restricted"."""

    def __init__(self, cluster: Cluster, namespace: str) -> None:
        self.cluster, self.namespace = cluster, namespace
        cluster.run("kubectl", "create", "namespace", namespace)
        levels = [f"pod-security.kubernetes.io/{one}=restricted" for one in ("enforce", "warn")]
        cluster.run("kubectl", "label", "namespace", namespace, *levels)
        account = lambda: cluster.get(namespace, "serviceaccounts")  # noqa: E731
        wait_until(account, "the namespace's service account")

    def helm(self, *arguments: str, check: bool = True) -> str:
        """What helm and the cluster said."""
        ran = self.cluster.run("helm", "-n", self.namespace, *arguments, check=check)
        return ran.stdout + ran.stderr

    def put(self, robots: int = 1, chart: Path = CHART, check: bool = True, **values: Any) -> str:
        """Install or upgrade to so many robots."""
        named = [{"name": f"r{n}", "domain": n} for n in range(1, robots + 1)]
        given = _as_flags({"robots": named} | values)
        return self.helm("upgrade", "--install", "fleet", str(chart), *given, check=check)

    def pods(self) -> dict[str, dict[str, Any]]:
        found = self.cluster.get(self.namespace, "pods", RELEASE)
        return {one["metadata"]["labels"]["edgevox/robot"]: one for one in found}

    def runs(self, tag: str, robots: int = 1) -> Callable[[], bool]:
        """Whether so many robots have pods of the image's tag, and no others have one."""

        def look() -> bool:
            images = [one["spec"]["containers"][0]["image"] for one in self.pods().values()]
            return images == [f"edgevox-ros2:{tag}"] * robots

        return look

    def uid(self) -> str:
        (pod,) = self.pods().values()
        return str(pod["metadata"]["uid"])


def _as_flags(values: dict[str, Any]) -> list[str]:
    return [f"--set-json={name}={json.dumps(value)}" for name, value in values.items()]
