"""What a robot of one's own needs of the chart: its files, plug-ins, recorder and alerts."""

import os
import subprocess
import time
from pathlib import Path
from typing import Any

import helm_python as helm
import pytest
import yaml
from chart_rig import ONE, chart, environment, objects, pods, solo, validate
from guards import HUNG_S

from edgevox.apps.container import prepared
from edgevox.apps.recorder import parse_arguments
from edgevox.ros2.recordings import UPLOAD_DONE, UPLOAD_FAILED, WhenFull
from edgevox.ros2.robot_file.load import load_robot_file

EXAMPLES = sorted(
    one for one in (chart.CHART / "examples").glob("*.yaml") if "rendered" not in one.name
)
VERSIONS = ("1.27", "1.37")
WHOLE = {
    "robots": [
        {"name": "a", "domain": 1, "recorder": {"enabled": True}},
        {"name": "b", "domain": 2, "files": {"configMap": "b-files"}},
    ],
    "files": {"data": {"world.yaml": "world: {}\n"}},
    "plugins": {"volume": {"configMap": {"name": "wheels"}}, "agent": "robot-porter"},
    "user": {"groups": [29]},
}


def known_rules(values: dict[str, Any], tmp_path: Any) -> list[dict[str, Any]]:
    """What the chart makes where the cluster knows Prometheus' kinds."""
    copy = tmp_path / "edgevox"
    for file in (one for one in chart.CHART.rglob("*") if one.is_file()):
        target = copy / file.relative_to(chart.CHART)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(file.read_text().replace('Has "monitoring.coreos.com/v1"', 'Has "v1"'))
    return chart.documents(chart.render(values, copy))


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_every_example_is_what_helm_and_kubernetes_take(file) -> None:
    values = yaml.safe_load(file.read_text())
    assert helm.lint(str(chart.CHART), values, strict=True)["errors"] == []
    for one in chart.documents(chart.render(values)):
        for version in VERSIONS:
            validate(one, version)


@pytest.mark.parametrize("version", VERSIONS)
def test_files_plug_ins_and_a_recorder_are_what_kubernetes_knows(version: str) -> None:
    for one in chart.documents(chart.render(WHOLE)):
        validate(one, version)


def test_a_robots_files_are_a_folder_that_the_entrypoint_takes(tmp_path) -> None:
    own = {"robot.yaml": "namespace: /x\n", "places.yaml": "dock: {x: 0, y: 0}\n"}
    values = ONE | {"agent": "robot-external", "files": {"data": own}}
    pod = pods(values)["solo"]
    (mount,) = [m for m in pod["containers"][0]["volumeMounts"] if m["name"] == "files"]
    (volume,) = [v for v in pod["volumes"] if v["name"] == "files"]
    (made,) = objects(values, "ConfigMap")

    assert mount["readOnly"] is True
    assert volume["configMap"] == {"name": made["metadata"]["name"]}
    assert made["data"] == own
    given = environment(pod)
    assert given["EDGEVOX_ROBOT_FOLDER"] == mount["mountPath"]
    for name, text in made["data"].items():
        (tmp_path / name).write_text(text)
    found = prepared(given | {"EDGEVOX_ROBOT_FOLDER": str(tmp_path)}, pytest.fail)
    assert found["EDGEVOX_ROBOT_FILE"] == str(tmp_path / "robot.yaml")
    assert found["EDGEVOX_LOCATIONS"] == str(tmp_path / "places.yaml")


def test_a_file_that_changes_makes_a_new_pod_and_a_robots_own_take_the_place_of_common_ones():
    def annotations(values: dict[str, Any]) -> list[dict[str, str]]:
        found = objects(values, "StatefulSet")
        return [one["spec"]["template"]["metadata"].get("annotations", {}) for one in found]

    a, b = annotations(WHOLE)
    assert a.keys() == {"edgevox/files"}
    assert b == {}
    assert annotations(WHOLE | {"files": {"data": {"world.yaml": "world: {width: 1}\n"}}})[0] != a
    assert annotations(ONE) == [{}]
    volumes = {one["name"]: one for one in pods(WHOLE)["b"]["volumes"]}
    assert volumes["files"]["configMap"] == {"name": "b-files"}


def test_plug_ins_are_mounted_read_only_and_name_their_robot() -> None:
    plugins = {"volume": {"persistentVolumeClaim": {"claimName": "p"}}, "agent": "robot-mine"}
    pod = solo(plugins=plugins)
    (mount,) = [m for m in pod["containers"][0]["volumeMounts"] if m["name"] == "plugins"]

    assert mount == {"name": "plugins", "mountPath": "/plugins", "readOnly": True}
    assert {"name": "plugins", **plugins["volume"]} in pod["volumes"]
    assert environment(pod)["EDGEVOX_PLUGINS"] == "/plugins"
    assert environment(pod)["EDGEVOX_AGENT"] == "robot-mine"
    assert "EDGEVOX_PLUGINS" not in environment(solo())


def test_a_recorder_is_beside_its_robot_with_a_claim_of_its_own() -> None:
    values = ONE | {"recorder": {"enabled": True, "size": "5Gi", "storageClass": "fast"}}
    (workload,) = objects(values, "StatefulSet")
    robot, recorder = workload["spec"]["template"]["spec"]["containers"]
    (claim,) = workload["spec"]["volumeClaimTemplates"]
    given, of_robot = ({e["name"]: e["value"] for e in c["env"]} for c in (recorder, robot))

    program, *arguments = recorder["args"]
    assert program == "edgevox-recorder"
    told = parse_arguments(arguments)
    assert told.output == Path("/recordings")
    assert (told.most_mb, told.max_size_mb, told.spare_mb) == (9000, 256, 500)
    assert told.when_full is WhenFull.RING
    assert recorder["securityContext"] == robot["securityContext"]
    assert {"name": "recordings", "mountPath": "/recordings"} in recorder["volumeMounts"]
    assert claim["metadata"]["name"] == "recordings"
    assert claim["spec"]["storageClassName"] == "fast"
    assert claim["spec"]["resources"]["requests"]["storage"] == "5Gi"
    for same in ("ROS_DOMAIN_ID", "EDGEVOX_AGENT_NAMESPACE", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
        assert given[same] == of_robot[same]
    assert given["EDGEVOX_HEALTH_PORT"] != of_robot["EDGEVOX_HEALTH_PORT"]
    prepared(given, pytest.fail)
    assert len(solo()["containers"]) == 1


def test_the_bounds_and_the_port_of_a_recorder_are_values() -> None:
    def recorder(**values: Any) -> dict[str, Any]:
        return pods(ONE | {"recorder": {"enabled": True, **values}})["solo"]["containers"][1]

    made = recorder(mostMb=700, fileMb=50, spareMb=1, whenFull="wait", healthPort=8123)
    told = parse_arguments(made["args"][1:])
    assert (told.most_mb, told.max_size_mb, told.spare_mb) == (700, 50, 1)
    assert told.when_full is WhenFull.WAIT
    assert environment({"containers": [made]})["EDGEVOX_HEALTH_PORT"] == "8123"
    assert made["livenessProbe"]["httpGet"] == {"path": "/live", "port": 8123}
    with pytest.raises(helm.HelmError, match=r"recorder.mostMb: got 300, expected at least twice"):
        recorder(mostMb=300)


def test_a_recorder_has_nothing_of_what_its_robot_is_made_of() -> None:
    secret = {"name": "TOKEN", "valueFrom": {"secretKeyRef": {"name": "s", "key": "k"}}}
    pod = pods(WHOLE | {"policy": {"limits": {"distance_m": 5}}, "env": [secret]})["a"]
    _, recorder = pod["containers"]

    assert {m["name"] for m in recorder["volumeMounts"]} == {"tmp", "shm", "recordings"}
    names = {one["name"] for one in recorder["env"]}
    assert not names & {"TOKEN", "EDGEVOX_PLUGINS", "EDGEVOX_ROBOT_FOLDER", "EDGEVOX_POLICY"}
    assert environment({"containers": [recorder]})["EDGEVOX_AGENT"] == "robot-apartment"


def test_recordings_go_to_a_volume_that_is_named() -> None:
    volume = {"persistentVolumeClaim": {"claimName": "mine"}}
    values = ONE | {"recorder": {"enabled": True, "volume": volume}}
    (workload,) = objects(values, "StatefulSet")

    assert "volumeClaimTemplates" not in workload["spec"]
    assert {"name": "recordings", **volume} in pods(values)["solo"]["volumes"]


def test_the_alerts_are_those_of_prometheus_made_only_if_asked_and_known(tmp_path) -> None:
    assert chart.ALERTS.read_text() == chart.alerts(), "scripts/chart.py write"
    asked = ONE | {"prometheusRule": {"enabled": True, "labels": {"release": "prometheus"}}}
    assert objects(asked, "PrometheusRule") == []
    assert "No PrometheusRule was made" in chart.render(asked)["edgevox/templates/NOTES.txt"]

    (rule,) = [one for one in known_rules(asked, tmp_path) if one["kind"] == "PrometheusRule"]
    assert rule["spec"] == yaml.safe_load(chart.OBSERVABILITY.read_text())
    assert rule["metadata"]["labels"]["release"] == "prometheus"


def test_a_group_for_a_device_is_a_group_more() -> None:
    assert pods(WHOLE)["a"]["securityContext"]["supplementalGroups"] == [29]
    assert "supplementalGroups" not in solo()["securityContext"]


def test_the_robot_file_of_the_example_is_one(tmp_path) -> None:
    values = yaml.safe_load((chart.CHART / "examples" / "own-robot.yaml").read_text())
    for name, text in values["robots"][0]["files"]["data"].items():
        (tmp_path / name).write_text(text)
    assert load_robot_file(tmp_path / "robot.yaml").robot.skills.keys() == {"brush"}


UPLOAD = {"recorder": {"enabled": True, "upload": {"to": "store:robots/", "secretName": "s3"}}}


def upload_of(values: dict[str, Any]) -> list[dict[str, Any]]:
    return [one for one in pods(values)["solo"]["containers"] if one["name"] == "upload"]


@pytest.mark.parametrize("version", VERSIONS)
def test_recordings_go_to_object_storage_by_the_command_that_compose_has(version: str) -> None:
    for one in chart.documents(chart.render(ONE | UPLOAD)):
        validate(one, version)
    (made,) = upload_of(ONE | UPLOAD)
    given = {one["name"]: one["value"] for one in made["env"]}
    assert given["UPLOAD_TO"] == "store:robots/solo"
    assert (given["UPLOAD_VERB"], given["UPLOAD_EVERY_S"]) == ("copy", "60")
    compose = yaml.safe_load((chart.CHART.parents[1] / "compose/recordings.yml").read_text())
    service = compose["services"]["recordings"]
    (script,) = service["command"]
    script = script.replace("$$RECORDINGS_", "$UPLOAD_").replace("$$", "$")
    assert made["args"] == [
        script.replace("secrets/recordings_config", "secrets/rclone/rclone.conf")
    ]
    assert made["image"] in service["image"]
    assert made["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    mounts = {one["name"]: one for one in made["volumeMounts"]}
    assert mounts["upload-config"]["readOnly"]
    volumes = {one["name"]: one for one in pods(ONE | UPLOAD)["solo"]["volumes"]}
    assert volumes["upload-config"]["secret"]["secretName"] == "s3"
    (recorder,) = [
        one for one in pods(ONE | UPLOAD)["solo"]["containers"] if one["name"] == "recorder"
    ]
    assert all(one["name"] != "upload-config" for one in recorder["volumeMounts"])
    assert "readinessProbe" not in made, "a store that is down does not make the robot unready"


def test_a_recorders_metrics_are_served_where_a_robots_are() -> None:
    def served(values: dict[str, Any]) -> tuple[str, bool, bool, bool]:
        kept = values | {"recorder": {"enabled": True, "metricsPort": 9500}}
        (recorder,) = [one for one in pods(kept)["solo"]["containers"] if one["name"] == "recorder"]
        (told,) = [o["value"] for o in recorder["env"] if o["name"] == "EDGEVOX_METRICS_PORT"]
        (policy,) = objects(kept, "NetworkPolicy")
        (service,) = objects(kept, "Service")
        open_to = [port["port"] for rule in policy["spec"]["ingress"] for port in rule["ports"]]
        return (
            told,
            {"name": "rec-metrics", "containerPort": 9500} in recorder.get("ports", []),
            "rec-metrics" in open_to,
            {"name": "rec-metrics", "port": 9500, "targetPort": "rec-metrics"}
            in service["spec"]["ports"],
        )

    monitored = {
        "serviceMonitor": {"enabled": True},
        "networkPolicy": {"monitoring": [{"podSelector": {}}]},
    }
    assert served(ONE | monitored) == ("9500", True, True, True)
    assert served(ONE) == ("0", False, False, False)


UPLOADER = """#!/bin/sh
echo "$@" >>"$LOG"
[ "$(wc -l <"$LOG")" -gt 1 ]
"""
"""In the place of rclone: its first run fails."""


def test_an_upload_that_failed_is_told_until_one_succeeds(tmp_path) -> None:
    (made,) = upload_of(ONE | UPLOAD)
    (tmp_path / "rclone").write_text(UPLOADER)
    (tmp_path / "sleep").write_text('#!/bin/sh\necho "$1" >"$WAITS"\nread _ <"$GO"\n')
    for name in ("rclone", "sleep"):
        (tmp_path / name).chmod(0o755)
    for name in ("waits", "go"):
        os.mkfifo(tmp_path / name)
    given = {one["name"]: one["value"] for one in made["env"]} | {
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
        "LOG": str(tmp_path / "log"),
        "WAITS": str(tmp_path / "waits"),
        "GO": str(tmp_path / "go"),
    }
    told = []
    recordings = tmp_path / "recordings"
    recordings.mkdir()
    loop = loop_in(made, tmp_path, recordings)
    with subprocess.Popen([*made["command"], loop], env=given) as process:
        for _ in range(2):
            assert (tmp_path / "waits").read_text() == "60\n"
            told.append([(recordings / one).exists() for one in (UPLOAD_FAILED, UPLOAD_DONE)])
            assert (tmp_path / "ended").exists()
            if len(told) == 2:
                process.kill()
            (tmp_path / "go").write_text("\n")
    assert told == [[True, False], [False, True]]
    assert (recordings / UPLOAD_DONE).read_text() == "60\n"
    first = (tmp_path / "log").read_text().splitlines()[0]
    assert " copy /recordings store:robots/solo --include *.{mcap,yaml} --immutable " in first
    assert "min-age" not in first


def loop_in(made: dict[str, Any], tmp: Path, recordings: Path) -> str:
    """The uploader's loop, with these folders in the place of the container's."""
    (loop,) = made["args"]
    return loop.replace("/tmp/", f"{tmp}/").replace(" /recordings/", f" {recordings}/")  # noqa: S108


@pytest.mark.parametrize("rclone", ["true", "false"])
def test_an_upload_that_cannot_leave_its_notes_ends_with_their_reason(tmp_path, rclone) -> None:
    (made,) = upload_of(ONE | UPLOAD)
    (tmp_path / "rclone").symlink_to(f"/bin/{rclone}")
    (tmp_path / "sleep").symlink_to("/bin/true")
    given = {one["name"]: one["value"] for one in made["env"]}
    given |= {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    loop = loop_in(made, tmp_path, Path("/proc/self/recordings"))  # where nobody makes a file
    ended = subprocess.run(
        [*made["command"], loop], env=given, capture_output=True, text=True, timeout=HUNG_S
    )
    assert ended.returncode == 1
    assert "/proc/self/recordings/upload." in ended.stderr


def test_an_upload_of_which_no_run_ends_is_started_again(tmp_path) -> None:
    (made,) = upload_of(ONE | UPLOAD)
    ended = tmp_path / "ended"
    ended.touch()
    probe = [
        part.replace("/tmp/ended", str(ended))  # noqa: S108
        for part in made["livenessProbe"]["exec"]["command"]
    ]
    assert subprocess.run(probe).returncode == 0
    hours_ago = time.time() - 3 * 3600
    os.utime(ended, (hours_ago, hours_ago))
    assert subprocess.run(probe).returncode == 1


def test_nothing_is_uploaded_unless_it_is_said_where_and_by_what() -> None:
    assert upload_of(ONE | {"recorder": {"enabled": True}}) == []
    off = {"recorder": {**UPLOAD["recorder"], "enabled": False}}
    assert upload_of(ONE | off) == []


def test_the_store_may_be_reached_and_nobody_else_for_it() -> None:
    def ports(values: dict[str, Any]) -> list[Any]:
        (policy,) = objects(values, "NetworkPolicy")
        return [
            one
            for one in policy["spec"]["egress"]
            if {"protocol": "TCP", "port": 443} in one["ports"]
        ]

    assert ports(ONE | {"recorder": {"enabled": True}}) == []
    assert ports(ONE | UPLOAD) == [{"ports": [{"protocol": "TCP", "port": 443}]}]
    peers = [{"ipBlock": {"cidr": "10.1.2.3/32"}}]
    (rule,) = ports(ONE | UPLOAD | {"networkPolicy": {"upload": peers}})
    assert rule["to"] == peers
