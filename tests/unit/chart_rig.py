"""The chart, rendered without a cluster, and what a test looks for in it."""

import json
import sys
from functools import cache
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

import chart
import kubernetes_validate
from kubernetes_validate import utils

# It reads all of Kubernetes' definitions for each object anew, and changes nothing in them.
utils.schema_contents = cache(utils.schema_contents)

ONE = {"robots": [{"name": "solo", "domain": 7}]}


def objects(values: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    rendered = _rendered(json.dumps(values))
    return [one for one in chart.documents(rendered) if one["kind"] == kind]


@cache
def _rendered(values: str) -> dict[str, str]:
    """Many tests look at a part each of what Helm makes of the same values."""
    return chart.render(json.loads(values))


def validate(one: dict[str, Any], version: str) -> None:
    """Raises an error where this object is not what Kubernetes of this version knows."""
    kubernetes_validate.validate(one, version, strict=True)


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
