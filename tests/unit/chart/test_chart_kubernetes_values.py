"""Kubernetes' own words in the values are taken. Wrong ones: tests/wrong/chart."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
import yaml
from chart_rig import ONE, chart, pods, solo

SPREAD = {"maxSkew": 1, "topologyKey": "zone", "whenUnsatisfiable": "ScheduleAnyway"}
DEFINITIONS = json.loads(chart.SCHEMA.read_text())["definitions"]


def peer(**fields: Any) -> dict[str, Any]:
    return {"networkPolicy": {"peers": [fields]}}


@pytest.mark.parametrize(
    "values",
    [
        {"resources": {"limits": {"memory": "1.5Gi", "cpu": 2, "nvidia.com/gpu": 1}}},
        {"resources": {"requests": {"cpu": "250m", "memory": 1000000}}},
        {"tolerations": [{"operator": "Exists"}, {"key": "a", "value": "b"}]},
        {"topologySpreadConstraints": [SPREAD | {"minDomains": 2, "matchLabelKeys": ["a/b"]}]},
        {"models": {"volume": {"image": {"reference": "r.example/models@sha256:0"}}}},
        {"models": {"volume": {"csi": {"driver": "d.example"}}}},
        {"env": [{"name": "A", "valueFrom": {"fieldRef": {"fieldPath": "status.hostIP"}}}]},
        {"podLabels": {"example.org/site": "north-1"}},
    ],
)
def test_what_kubernetes_takes_is_taken(values: dict[str, Any]) -> None:
    assert solo(**values)


def test_a_peer_by_its_address_or_labels_is_taken() -> None:
    for one in ({"ipBlock": {"cidr": "fd00::/8"}}, {"podSelector": {}, "namespaceSelector": {}}):
        assert pods(ONE | peer(**one))


def objects_without_bounds(schema: Any, path: str = "") -> Iterator[str]:
    """Where a schema takes an object of whatever keys and values."""
    if isinstance(schema, list):
        for index, one in enumerate(schema):
            yield from objects_without_bounds(one, f"{path}/{index}")
    if not isinstance(schema, dict):
        return
    bounds = {"additionalProperties", "propertyNames"}
    if schema.get("type") == "object" and not bounds & schema.keys():
        yield path
    for name, one in schema.items():
        yield from objects_without_bounds(one, f"{path}/{name}")


def test_only_the_inside_of_a_source_is_left_to_the_cluster() -> None:
    schema = json.loads(chart.SCHEMA.read_text())
    del schema["definitions"]["policy"]  # the policy's own format
    free = set(objects_without_bounds(schema))
    sources = ("volume", "extraVolume", "variable/properties/valueFrom")
    inside = tuple(f"/definitions/kubernetes.{one}/properties/" for one in sources)

    assert {path for path in free if not path.startswith(inside)} == {"/properties/global"}


OWN = {"name", "domain", "agentNamespace", "namespace"}


def test_an_entry_of_robots_is_held_to_the_same_words_as_all_robots() -> None:
    everywhere = json.loads(chart.SCHEMA.read_text())["properties"]
    properties = DEFINITIONS["robot"]["properties"]

    assert properties.keys() - everywhere.keys() == OWN
    for name in properties.keys() & everywhere.keys():
        assert properties[name] in ({"$ref": f"#/properties/{name}"}, everywhere[name])


def test_every_value_that_has_a_default_is_in_the_schema_and_the_other_way() -> None:
    values = yaml.safe_load((chart.CHART / "values.yaml").read_text())
    schema = json.loads(chart.SCHEMA.read_text())["properties"]

    old = {"externalNamespace"}
    assert values.keys() == schema.keys() - {"global"} - old
