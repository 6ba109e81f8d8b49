"""Kubernetes' own words in the values: nonsense is refused by its path."""

import json
from collections.abc import Iterator
from typing import Any

import helm_python as helm
import pytest
import yaml
from chart_rig import ONE, chart, pods, solo

SPREAD = {"maxSkew": 1, "topologyKey": "zone", "whenUnsatisfiable": "ScheduleAnyway"}
CLAIM = {"persistentVolumeClaim": {"claimName": "x"}}
NAMED = {"name": "x", "mountPath": "/x"}
DEFINITIONS = json.loads(chart.SCHEMA.read_text())["definitions"]


def peer(**fields: Any) -> dict[str, Any]:
    return {"networkPolicy": {"peers": [fields]}}


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"resources": {"limits": {"memory": "4 GB"}}}, "/resources/limits/memory"),
        ({"resources": {"limits": {"memory": -1}}}, "/resources/limits/memory"),
        ({"resources": {"requests": {"ram": "4Gi"}}}, "'ram'"),
        ({"resources": {"limit": {}}}, "limit"),
        ({"recorder": {"size": "ten"}}, "/recorder/size"),
        ({"recorder": {"resources": {"limits": {"cpu": "two"}}}}, "/recorder/resources/limits/cpu"),
        ({"recorder": {"storageClass": "Fast Disk"}}, "/recorder/storageClass"),
        ({"tmpSize": "much"}, "tmpSize"),
        ({"nodeSelector": {"edgevox/body": True}}, "/nodeSelector/edgevox~1body"),
        ({"nodeSelector": {"not a key": "x"}}, "'not a key'"),
        ({"nodeSelector": {"a": "no spaces"}}, "/nodeSelector/a"),
        ({"tolerations": [{"key": "a", "effect": "NoRun"}]}, "/tolerations/0/effect"),
        ({"tolerations": [{"key": "a", "operator": "Exist"}]}, "/tolerations/0/operator"),
        ({"tolerations": [{"effect": "NoSchedule"}]}, "/tolerations/0"),
        ({"tolerations": [{"kee": "a"}]}, "kee"),
        ({"topologySpreadConstraints": [SPREAD | {"maxSkew": 0}]}, "/0/maxSkew"),
        ({"topologySpreadConstraints": [{"maxSkew": 1}]}, "topologyKey"),
        ({"topologySpreadConstraints": [SPREAD | {"labelSelector": {"app": "x"}}]}, "app"),
        ({"affinity": {"podAntiAfinity": {}}}, "podAntiAfinity"),
        ({"affinity": {"nodeAffinity": {"required": {}}}}, "required"),
        ({"priorityClassName": "Very High"}, "/priorityClassName"),
        ({"runtimeClassName": "NVIDIA"}, "/runtimeClassName"),
        ({"serviceAccountName": "a b"}, "/serviceAccountName"),
        ({"podLabels": {"a": "b c"}}, "/podLabels/a"),
        ({"podAnnotations": {"a b": "c"}}, "'a b'"),
        ({"models": {"volume": {"pvc": {}}}}, "pvc"),
        ({"models": {"volume": CLAIM | {"emptyDir": {}}}}, "/models/volume"),
        ({"places": {"volume": {"hostPath": "/srv"}}}, "/places/volume/hostPath"),
        ({"extraVolumes": [{"name": "x"}]}, "/extraVolumes/0"),
        ({"extraVolumes": [CLAIM]}, "name"),
        ({"extraVolumeMounts": [{"name": "x"}]}, "mountPath"),
        ({"extraVolumeMounts": [NAMED | {"mountPath": "x"}]}, "/extraVolumeMounts/0/mountPath"),
        ({"extraVolumeMounts": [NAMED | {"readonly": True}]}, "readonly"),
        ({"env": [{"name": "A", "value": "b", "valueFrom": {"fieldRef": {}}}]}, "/env/0"),
        ({"env": [{"name": "A", "valueFrom": {"secret": {}}}]}, "secret"),
        ({"image": {"pullSecrets": [""]}}, "/image/pullSecrets/0"),
        ({"image": {"pullSecrets": ["A_B"]}}, "/image/pullSecrets/0"),
        ({"llm": {"endpointKeySecret": {"name": "The Key"}}}, "/llm/endpointKeySecret/name"),
        (peer(ipBlock={"cidr": "192.168.1.0"}), "/networkPolicy/peers/0/ipBlock/cidr"),
        (peer(ipBlock={"cidr": "10.0.0.0/8"}, podSelector={}), "/networkPolicy/peers/0"),
        (peer(podselector={}), "podselector"),
        (peer(), "/networkPolicy/peers/0"),
        ({"serviceMonitor": {"labels": {"a": 1}}}, "/serviceMonitor/labels/a"),
        ({"podDisruptionBudget": {"maxUnavailable": -1}}, "maxUnavailable"),
        ({"podDisruptionBudget": {"minAvailable": 1}}, "minAvailable"),
        ({"health": {"startSeconds": 1}}, "/health/startSeconds"),
        ({"discovery": {"peersWaitSeconds": 61}}, "/discovery/peersWaitSeconds"),
        ({"updateStrategy": "Recreate"}, "/updateStrategy"),
    ],
)
def test_nonsense_in_what_is_kubernetes_own_is_refused_by_its_path(values, named: str) -> None:
    for given in (values, {"robots": [{"name": "a", "domain": 1} | values]}):
        if given is values or values.keys() <= DEFINITIONS["robot"]["properties"].keys():
            with pytest.raises(helm.HelmValuesError) as refused:
                chart.render(given)
            assert named in str(refused.value)


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
