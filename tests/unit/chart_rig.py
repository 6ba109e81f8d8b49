"""The chart, rendered without a cluster, and what a test looks for in it."""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

import chart

ONE = {"robots": [{"name": "solo", "domain": 7}]}


def objects(values: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    return [one for one in chart.documents(chart.render(values)) if one["kind"] == kind]


def pods(values: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The pod's specification of each robot, by its name."""
    return {
        one["metadata"]["labels"]["edgevox/robot"]: one["spec"]["template"]["spec"]
        for one in objects(values, "StatefulSet")
        if "edgevox/robot" in one["metadata"]["labels"]
    }


def environment(pod: dict[str, Any]) -> dict[str, str]:
    return {one["name"]: one["value"] for one in pod["containers"][0]["env"]}


def solo(**robot: Any) -> dict[str, Any]:
    """The pod of the only robot."""
    return pods({"robots": [{"name": "solo", "domain": 7, **robot}]})["solo"]
