"""The chart as a cluster would take it: rendered, linted, valid, and without a right too many."""

from typing import Any

import helm_python as helm
import pytest
import yaml
from chart_rig import ONE, chart, environment, objects, pods, solo, validate

from edgevox.agent.policy.policy import PolicyFile, parse_policy
from edgevox.core.status import STALL_S
from edgevox.core.version import DECLARED

FLEET = yaml.safe_load(chart.FLEET.read_text())
OLDEST, NEWEST = "1.27", "1.37"
EVERYTHING = {
    "robots": [
        {"name": "solo", "domain": 232, "hostNetwork": True},
        {"name": "b", "domain": 0, "framePrefix": "b/"},
    ],
    "image": {"repository": "r.example:5000/a/b", "digest": "sha256:" + 64 * "0"}
    | {"pullSecrets": ["registry"]},
    "env": [{"name": "A", "valueFrom": {"secretKeyRef": {"name": "s", "key": "k"}}}],
    "llm": {"endpoint": "https://[::1]/v1", "endpointKeySecret": {"name": "llm"}},
    "models": {"volume": {"hostPath": {"path": "/models", "type": "Directory"}}, "verify": True},
    "policy": {"rules": {"*": {"*": "confirm"}}, "limits": {"distance_m": 5}},
    "tolerations": [{"operator": "Exists"}],
    "nodeSelector": {"a": "b"},
    "affinity": {"podAntiAffinity": {}},
    "topologySpreadConstraints": [
        {"maxSkew": 1, "topologyKey": "zone", "whenUnsatisfiable": "ScheduleAnyway"},
        {"maxSkew": 1, "topologyKey": "zone", "whenUnsatisfiable": "ScheduleAnyway"}
        | {"labelSelector": {"matchLabels": {"edgevox/domain": "0"}}},
    ],
    "priorityClassName": "robots",
    "runtimeClassName": "nvidia",
    "podAnnotations": {"a": "b"},
    "podLabels": {"a": "b"},
    "serviceAccountName": "robots",
    "discovery": {"server": "dds.example:11811;other:11812"},
    "networkPolicy": {"peers": [{"ipBlock": {"cidr": "192.168.1.0/24"}}]}
    | {"monitoring": [{"namespaceSelector": {}}], "llm": [{"podSelector": {}}]},
    "serviceMonitor": {"enabled": True},
    "extraVolumes": [{"name": "x", "emptyDir": {}}],
    "extraVolumeMounts": [{"name": "x", "mountPath": "/x"}],
}


@pytest.mark.parametrize("values", [{}, ONE, FLEET, EVERYTHING])
def test_helm_finds_nothing_to_complain_about(values: dict[str, Any]) -> None:
    report = helm.lint(str(chart.CHART), values, strict=True)

    assert report["errors"] == []
    assert [m["error"] for m in report["messages"]] == ["icon is recommended"]


@pytest.mark.parametrize("version", [OLDEST, NEWEST])
@pytest.mark.parametrize("values", [{}, ONE, FLEET, EVERYTHING])
def test_every_object_is_what_kubernetes_knows(values: dict[str, Any], version: str) -> None:
    for one in chart.documents(chart.render(values)):
        validate(one, version)


def test_the_fleet_is_rendered_as_it_was_when_somebody_looked_at_it() -> None:
    assert chart.RENDERED.read_text() == chart.fleet(), "scripts/chart.py write, and read the diff"


def test_each_robot_is_one_workload_that_never_runs_twice() -> None:
    (first, *_) = found = objects(FLEET, "StatefulSet")

    assert [one["metadata"]["name"] for one in found] == [
        f"fleet-edgevox-{robot['name']}" for robot in FLEET["robots"]
    ]
    assert {one["spec"]["replicas"] for one in found} == {1}
    assert first["spec"]["serviceName"] == objects(FLEET, "Service")[0]["metadata"]["name"]


def test_a_workload_selects_its_own_pod_and_no_other() -> None:
    found = objects(FLEET, "StatefulSet")
    for one in found:
        wanted = one["spec"]["selector"]["matchLabels"].items()
        matched = [
            o for o in found if wanted <= o["spec"]["template"]["metadata"]["labels"].items()
        ]
        assert matched == [one]


@pytest.mark.parametrize("values", [ONE, FLEET, EVERYTHING])
def test_no_robot_has_a_right_that_it_does_not_need(values: dict[str, Any]) -> None:
    for pod in pods(values).values():
        (container,) = pod["containers"]
        assert pod["automountServiceAccountToken"] is False
        assert pod["securityContext"]["runAsNonRoot"] is True
        assert pod["securityContext"]["runAsUser"] == 1000
        assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
        assert not {"hostPID", "hostIPC"} & pod.keys()
        assert container["securityContext"] == {
            "allowPrivilegeEscalation": False,
            "readOnlyRootFilesystem": True,
            "capabilities": {"drop": ["ALL"]},
        }


def test_what_is_written_is_bounded_and_in_memory_but_for_places() -> None:
    pod = solo()
    mounts = {one["mountPath"]: one["name"] for one in pod["containers"][0]["volumeMounts"]}
    volumes = {one["name"]: one for one in pod["volumes"]}

    assert volumes[mounts.pop("/places")]["emptyDir"].keys() == {"sizeLimit"}
    assert mounts.keys() == {"/tmp", "/dev/shm"}  # noqa: S108 - the container's
    for name in mounts.values():
        assert volumes[name]["emptyDir"].keys() == {"medium", "sizeLimit"}


def test_remembered_places_last_as_long_as_the_pod_or_as_a_volume_that_is_named() -> None:
    claim = {"persistentVolumeClaim": {"claimName": "robot1-places"}}
    found = pods(
        {
            "places": {"volume": {"hostPath": {"path": "/srv"}}},
            "robots": [
                {"name": "a", "domain": 1, "places": {"volume": claim}},
                {"name": "b", "domain": 2, "places": {"volume": {}}},
                {"name": "c", "domain": 3},
            ],
        }
    )
    volumes = {
        name: next(one for one in pod["volumes"] if one["name"] == "places")
        for name, pod in found.items()
    }

    assert volumes["a"] == {"name": "places", **claim}
    assert volumes["b"] == {"name": "places", "emptyDir": {"sizeLimit": "16Mi"}}
    assert volumes["c"] == {"name": "places", "hostPath": {"path": "/srv"}}


def test_health_is_asked_over_http_in_a_pods_own_network() -> None:
    pod = solo(health={"port": 9001})
    (container,) = pod["containers"]

    assert container["livenessProbe"]["httpGet"] == {"path": "/live", "port": "health"}
    assert container["readinessProbe"]["httpGet"] == {"path": "/ready", "port": "health"}
    assert container["ports"] == [{"name": "health", "containerPort": 9001}]
    assert environment(pod)["EDGEVOX_HEALTH_PORT"] == "9001"
    assert environment(pod)["EDGEVOX_HEALTH_HOST"] == "0.0.0.0"  # noqa: S104 - a pod's own


def test_on_the_hosts_network_health_stays_on_loopback_and_dds_on_udp() -> None:
    pod = solo(hostNetwork=True)
    (container,) = pod["containers"]

    assert pod["hostNetwork"] is True
    assert container["readinessProbe"]["exec"]["command"] == ["edgevox-health", "--ready"]
    assert environment(pod)["EDGEVOX_HEALTH_HOST"] == "127.0.0.1"
    assert environment(pod)["FASTDDS_BUILTIN_TRANSPORTS"] == "UDPv4"
    assert "FASTDDS_BUILTIN_TRANSPORTS" not in environment(solo())


def test_what_is_frozen_is_ended_within_ten_seconds() -> None:
    (container,) = solo()["containers"]
    probe = container["livenessProbe"]

    assert STALL_S + probe["periodSeconds"] * probe["failureThreshold"] <= 10


def test_models_come_from_the_image_unless_a_volume_is_named() -> None:
    volume = {"persistentVolumeClaim": {"claimName": "models", "readOnly": True}}
    pod = solo(models={"volume": volume})

    assert "models" not in [one["name"] for one in solo()["volumes"]]
    assert {"name": "models", **volume} in pod["volumes"]
    assert {"name": "models", "mountPath": "/opt/edgevox/models", "readOnly": True} in pod[
        "containers"
    ][0]["volumeMounts"]


def test_a_robots_own_volume_takes_the_place_of_the_common_one() -> None:
    values = {
        "models": {"volume": {"hostPath": {"path": "/models"}}},
        "robots": [
            {"name": "a", "domain": 1, "models": {"volume": {"emptyDir": {}}}},
            {"name": "b", "domain": 2, "models": {"volume": {}}},
            {"name": "c", "domain": 3},
        ],
    }
    found = {
        name: [v for v in pod["volumes"] if v["name"] == "models"]
        for name, pod in pods(values).items()
    }

    assert found["a"] == [{"name": "models", "emptyDir": {}}]
    assert found["b"] == []
    assert found["c"] == [{"name": "models", "hostPath": {"path": "/models"}}]


def test_an_entry_overrules_what_counts_for_all_even_with_nothing_and_false() -> None:
    values = {
        "muted": True,
        "hostNetwork": True,
        "wakeword": "hey jarvis",
        "llm": {"endpoint": "http://llm:8080", "threads": 4},
        "resources": {"limits": {"memory": "8Gi"}},
        "robots": [
            {"name": "a", "domain": 1},
            {"name": "b", "domain": 2, "muted": False, "hostNetwork": False, "wakeword": ""}
            | {"llm": {"endpoint": "", "threads": 0}, "resources": {"limits": {"cpu": "2"}}},
        ],
    }
    common, own = (environment(pod) for pod in pods(values).values())

    assert (common["EDGEVOX_MUTED"], own["EDGEVOX_MUTED"]) == ("true", "false")
    assert common["EDGEVOX_WAKEWORD"] == "hey jarvis"
    assert common["EDGEVOX_LLM_ENDPOINT"] == "http://llm:8080"
    assert (common["EDGEVOX_LLM_THREADS"], own["EDGEVOX_LLM_THREADS"]) == ("4", "0")
    assert not {"EDGEVOX_WAKEWORD", "EDGEVOX_LLM_ENDPOINT"} & own.keys()
    assert "hostNetwork" not in pods(values)["b"]
    assert pods(values)["b"]["containers"][0]["resources"]["limits"] == {
        "cpu": "2",
        "memory": "8Gi",
    }


@pytest.mark.parametrize("part", ["llm", "stt", "tts"])
def test_the_key_of_an_endpoint_is_a_file_from_a_secret_and_no_variable(part: str) -> None:
    server = {"endpoint": "http://llm", "endpointKeySecret": {"name": "a-key", "key": "k"}}
    pod = solo(**{part: server})
    (mount,) = [m for m in pod["containers"][0]["volumeMounts"] if m["name"] == f"{part}-key"]
    (volume,) = [v for v in pod["volumes"] if v["name"] == f"{part}-key"]

    field = f"EDGEVOX_{part.upper()}_ENDPOINT_KEY_FILE"
    assert environment(pod)[field] == f"{mount['mountPath']}/key"
    assert mount["readOnly"] is True
    assert volume["secret"]["items"] == [{"key": "k", "path": "key"}]
    assert volume["secret"]["defaultMode"] == 0o440
    assert objects(ONE, "Secret") == []


def test_a_policy_is_a_file_of_a_folder_that_kubernetes_swaps_and_a_robots_own_takes_its_place():
    common, own = {"rules": {"voice": {"*": "deny"}}}, {"limits": {"distance_m": 5}}
    robots = [{"name": "a", "domain": 1}, {"name": "b", "domain": 2, "policy": own}]
    values = {"robots": [*robots, {"name": "c", "domain": 3, "policy": {}}], "policy": common}
    made = {
        one["metadata"]["name"]: parse_policy(one["data"]["policy.yaml"], "policy.yaml")
        for one in objects(values, "ConfigMap")
    }

    assert made == {
        "fleet-edgevox-a-policy": PolicyFile.model_validate(common),
        "fleet-edgevox-b-policy": PolicyFile.model_validate(own),
    }
    pod = pods(values)["a"]
    (mount,) = [m for m in pod["containers"][0]["volumeMounts"] if m["name"] == "policy"]
    (volume,) = [v for v in pod["volumes"] if v["name"] == "policy"]
    assert environment(pod)["EDGEVOX_POLICY"] == f"{mount['mountPath']}/policy.yaml"
    assert "subPath" not in mount
    assert volume["configMap"] == {"name": "fleet-edgevox-a-policy"}
    assert "EDGEVOX_POLICY" not in environment(pods(values)["c"])


def test_a_drain_stops_one_robot_at_a_time() -> None:
    (budget,) = objects(FLEET, "PodDisruptionBudget")

    assert budget["spec"]["maxUnavailable"] == 1
    assert objects(FLEET | {"podDisruptionBudget": {"enabled": False}}, "PodDisruptionBudget") == []


def test_a_service_monitor_is_made_only_if_asked_and_known() -> None:
    assert objects(ONE, "ServiceMonitor") == []
    assert objects(ONE | {"serviceMonitor": {"enabled": True}}, "ServiceMonitor") == []
    notes = chart.render(ONE | {"serviceMonitor": {"enabled": True}})
    assert "No ServiceMonitor was made" in notes["edgevox/templates/NOTES.txt"]


def test_where_it_is_known_a_service_monitor_reads_the_metrics_port(tmp_path, monkeypatch) -> None:
    copy = tmp_path / "edgevox"
    for file in (one for one in chart.CHART.rglob("*") if one.is_file()):
        target = copy / file.relative_to(chart.CHART)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(file.read_text().replace('Has "monitoring.coreos.com/v1"', 'Has "v1"'))
    values = ONE | {"serviceMonitor": {"enabled": True, "port": 9000, "labels": {"a": "b"}}}

    rendered = chart.documents(chart.render(values, copy))

    (monitor,) = [one for one in rendered if one["kind"] == "ServiceMonitor"]
    (service,) = [one for one in rendered if one["kind"] == "Service"]
    assert monitor["metadata"]["labels"]["a"] == "b"
    endpoints = monitor["spec"]["endpoints"]
    assert [one["port"] for one in endpoints] == ["metrics", "rec-metrics"]
    for endpoint in endpoints:
        assert endpoint["interval"] == "15s"
        assert [one["targetLabel"] for one in endpoint["relabelings"]] == ["robot", "domain"]
    assert {"name": "metrics", "port": 9000, "targetPort": "metrics"} in service["spec"]["ports"]


def test_metrics_are_served_where_prometheus_reads_them_and_nowhere_else() -> None:
    values = ONE | {"serviceMonitor": {"enabled": True, "port": 9000}}
    found = pods(values)["solo"]
    (container,) = found["containers"]
    assert environment(found)["EDGEVOX_METRICS_PORT"] == "9000"
    assert environment(found)["EDGEVOX_METRICS_HOST"] == environment(found)["EDGEVOX_HEALTH_HOST"]
    assert {"name": "metrics", "containerPort": 9000} in container["ports"]

    on_host = pods(values | {"hostNetwork": True})["solo"]
    for quiet in (solo(), on_host):
        assert environment(quiet)["EDGEVOX_METRICS_PORT"] == "0"
        assert "EDGEVOX_METRICS_HOST" not in environment(quiet)
        assert [one["name"] for one in quiet["containers"][0]["ports"]] == ["health"]
    own = {"EDGEVOX_METRICS_PORT": 9465}
    assert environment(solo(hostNetwork=True, settings=own))["EDGEVOX_METRICS_PORT"] == "9465"


def test_a_new_version_of_the_chart_alone_restarts_no_robot() -> None:
    for one in objects(FLEET | {"discovery": {"servers": True}}, "StatefulSet"):
        assert any("version" in label for label in one["metadata"]["labels"])
        labels = one["spec"]["template"]["metadata"]["labels"]
        assert not [label for label in labels if "version" in label or "chart" in label]


def test_a_robot_asks_for_the_disk_of_its_node_that_it_fills() -> None:
    def asked(**robot: Any) -> str:
        return solo(**robot)["containers"][0]["resources"]["requests"]["ephemeral-storage"]

    assert asked() == "50M"
    assert asked(console={"enabled": True, "recordings": {"mb": 500}}) == "650M"
    of_its_own = {"mb": 500, "volume": {"persistentVolumeClaim": {"claimName": "kept"}}}
    assert asked(console={"enabled": True, "recordings": of_its_own}) == "50M"
    assert asked(resources={"requests": {"ephemeral-storage": "1Gi"}}) == "1Gi"
    upload = {"to": "store:robots", "secretName": "rclone"}
    for one in solo(recorder={"enabled": True, "upload": upload})["containers"]:
        assert one["resources"]["requests"]["ephemeral-storage"], one["name"]
        assert "livenessProbe" in one, one["name"]


def test_the_chart_is_of_the_version_of_the_program() -> None:
    metadata = yaml.safe_load((chart.CHART / "Chart.yaml").read_text())

    assert metadata["appVersion"] == DECLARED
    assert metadata["version"] == DECLARED.replace(".dev", "-dev")
    assert solo()["containers"][0]["image"] == f"edgevox-ros2:{DECLARED}"


def test_a_digest_overrules_the_tag() -> None:
    digest = "sha256:" + 64 * "a"
    values = ONE | {"image": {"repository": "r.example/e", "tag": "x", "digest": digest}}

    assert pods(values)["solo"]["containers"][0]["image"] == f"r.example/e@{digest}"


def test_where_pods_run_is_kubernetes_own_words_untouched() -> None:
    (pod, _) = pods(EVERYTHING).values()

    for name in ("nodeSelector", "affinity", "priorityClassName", "runtimeClassName"):
        assert pod[name] == EVERYTHING[name]
    assert pod["tolerations"][0] == EVERYTHING["tolerations"][0]
    assert pod["topologySpreadConstraints"][1] == EVERYTHING["topologySpreadConstraints"][1]


def test_a_spread_that_selects_nobody_selects_the_robots_of_the_release() -> None:
    (workload, _) = objects(EVERYTHING, "StatefulSet")
    template = workload["spec"]["template"]
    (spread, _) = template["spec"]["topologySpreadConstraints"]
    selected = spread.pop("labelSelector")["matchLabels"]

    assert spread == EVERYTHING["topologySpreadConstraints"][0]
    assert selected.items() <= template["metadata"]["labels"].items()
    assert selected["app.kubernetes.io/instance"] == "fleet"
    assert "edgevox/robot" not in selected


def test_a_robot_out_of_the_radios_reach_is_not_evicted_unless_somebody_says_when() -> None:
    keys = ["node.kubernetes.io/unreachable", "node.kubernetes.io/not-ready"]
    forever = [{"key": key, "operator": "Exists", "effect": "NoExecute"} for key in keys]
    own = {"key": keys[0], "operator": "Exists", "effect": "NoExecute", "tolerationSeconds": 60}

    assert solo()["tolerations"] == forever
    assert solo(tolerations=[own])["tolerations"] == [own, forever[1]]


def test_a_pod_that_never_became_ready_does_not_hold_up_the_upgrade_that_mends_it() -> None:
    (workload,) = objects(ONE, "StatefulSet")

    assert workload["spec"]["podManagementPolicy"] == "Parallel"


def test_a_slow_machine_may_take_longer_until_it_first_answers() -> None:
    for seconds, times in {120: 60, 301: 151}.items():
        (container,) = solo(health={"startSeconds": seconds})["containers"]
        probe = container["startupProbe"]
        assert (probe["failureThreshold"], probe["periodSeconds"]) == (times, 2)


def test_the_longest_names_fit() -> None:
    with helm.Chart.load(str(chart.CHART)) as loaded:
        values = {"robots": [{"name": "r" * 25, "domain": 1}]}
        rendered = loaded.render(values, name="x" * 53, namespace="n" * 63)
    names = [one["metadata"]["name"] for one in chart.documents(rendered)]

    assert max(map(len, names)) <= 52
    assert not [name for name in names if name.endswith("-")]


@pytest.mark.parametrize(("drain_s", "grace_s"), [(20, 30), (0, 10), (2.5, 13)])
def test_a_pod_drains_first_and_is_killed_later_than_that_takes(drain_s, grace_s) -> None:
    pod = pods(FLEET | {"drainSeconds": drain_s})["robot1"]
    hook = pod["containers"][0]["lifecycle"]["preStop"]

    assert hook == {"exec": {"command": ["edgevox-health", "--drain"]}}
    assert float(environment(pod)["EDGEVOX_DRAIN_S"]) == drain_s
    assert pod["terminationGracePeriodSeconds"] == grace_s
