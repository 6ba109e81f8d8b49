"""Prometheus and Grafana beside a robot, and beside a fleet: as far as it shows without them."""

import json
import os
import re

import pytest
from guards import run_program
from stacks import BASE, ROOT

from edgevox.apps.recorder import parse_arguments
from edgevox.ros2.recordings import WhenFull

ANYWHERE = "0.0.0.0"  # noqa: S104 - within the network of a project
BY_DIGEST = r"([a-z]+/)?[a-z]+:v?[0-9.]+(-alpine)?@sha256:[0-9a-f]{64}"


def services(*overlays: str, **environment: str) -> dict:
    files = [BASE, *(f"compose/{name}.yml" for name in overlays)]
    command = ["docker", "compose", *(word for file in files for word in ("-f", file))]
    ran = run_program(
        [*command, "config", "--format", "json"], cwd=ROOT, env={**os.environ, **environment}
    )
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)["services"]


def test_the_robots_metrics_are_reached_in_the_project_and_from_nowhere_else():
    robot = services("observability")["edgevox-ros2"]

    assert robot["environment"]["EDGEVOX_METRICS_HOST"] == ANYWHERE
    assert "ports" not in robot
    assert "monitoring" not in robot["networks"]
    assert services("observability")["grafana"]["networks"].keys() == {"monitoring"}


def test_a_fleet_is_reached_if_it_is_told_to_listen():
    told = services("fleet", "observability", EDGEVOX_METRICS_HOST=ANYWHERE)

    for name in ("robot1", "robot2", "robot3"):
        assert told[name]["environment"]["EDGEVOX_METRICS_HOST"] == ANYWHERE
        assert told[name]["networks"].keys() <= told["prometheus"]["networks"].keys()


@pytest.mark.parametrize(
    ("overlay", "name"),
    [("logs", "loki"), ("logs", "alloy"), ("recordings", "recordings"), ("llm-queue", "llm-queue")],
)
def test_what_a_fleet_has_besides_is_the_very_image_and_changes_nothing_of_ours(overlay, name):
    service = services(overlay)[name]

    assert re.fullmatch(BY_DIGEST, service["image"])
    for mount in service["volumes"]:
        if mount["type"] == "bind":
            assert mount["read_only"]


def test_logs_are_collected_from_robots_alone_without_the_engines_socket():
    told = services("fleet", "observability", "logs")
    alloy = (ROOT / "compose" / "observability" / "robots.alloy").read_text()

    assert not any("docker.sock" in m["source"] for m in told["alloy"]["volumes"])
    named = {n for n, one in told.items() if "labels" in one["logging"].get("options", {})}
    assert named == {"robot1", "robot2", "robot3"}
    assert f'attrs.\\"{told["robot1"]["logging"]["options"]["labels"]}\\"' in alloy
    assert told["loki"]["networks"].keys() == told["grafana"]["networks"].keys()


def test_recordings_go_with_keys_from_outside_as_the_recorders_own_user():
    told = services("recorder", "recordings")

    assert told["recordings"]["secrets"][0]["source"] == "recordings_config"
    assert not [name for name in told["recordings"]["environment"] if "KEY" in name]
    assert {m["source"] for m in told["recordings"]["volumes"]} == {"recordings"}


def test_recordings_have_a_bound_and_their_recorder_a_port_that_can_be_set():
    told = parse_arguments(services("recorder")["recorder"]["command"][1:])
    assert (told.most_mb, told.max_size_mb, told.spare_mb) == (10_000, 256, 500)
    assert told.when_full is WhenFull.RING
    sizes = {"RECORDER_MOST_MB": "9", "RECORDER_FILE_MB": "4", "RECORDER_SPARE_MB": "3"}
    others = {"RECORDER_WHEN_FULL": "wait", "RECORDER_HEALTH_PORT": "8123"}
    recorder = services("recorder", **sizes, **others)["recorder"]
    told = parse_arguments(recorder["command"][1:])
    assert (told.most_mb, told.max_size_mb, told.spare_mb) == (9, 4, 3)
    assert told.when_full is WhenFull.WAIT
    assert recorder["environment"]["EDGEVOX_HEALTH_PORT"] == "8123"


@pytest.mark.parametrize("name", ["grafana", "prometheus"])
def test_it_is_seen_from_this_machine_only_and_is_the_very_image(name):
    service = services("observability")[name]

    assert [port["host_ip"] for port in service["ports"]] == ["127.0.0.1"]
    assert re.fullmatch(BY_DIGEST, service["image"])
    for mount in service["volumes"]:
        if mount["type"] == "bind":
            assert mount["read_only"]
            assert os.path.exists(mount["source"])


def test_nobody_can_log_in_and_whoever_looks_may_only_look():
    grafana = services("observability")["grafana"]["environment"]

    assert grafana["GF_AUTH_ANONYMOUS_ORG_ROLE"] == "Viewer"
    assert grafana["GF_SECURITY_DISABLE_INITIAL_ADMIN_CREATION"] == "true"
    assert grafana["GF_AUTH_BASIC_ENABLED"] == "false"
    assert not [name for name in grafana if "PASSWORD" in name or "SECRET" in name]


def test_on_the_hosts_network_metrics_are_off_until_a_port_is_named():
    robot = services("host")["edgevox-ros2"]["environment"]
    assert robot["EDGEVOX_METRICS_PORT"] == "0"
    told = services("host", EDGEVOX_METRICS_PORT="9465")["edgevox-ros2"]["environment"]
    assert told["EDGEVOX_METRICS_PORT"] == "9465"
