"""The files for systemd and Podman have the limits of compose, and what they start runs."""

import os
import shlex
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest
import yaml
from guards import HUNG_S

from edgevox.apps.container.environment import ENVIRONMENT
from edgevox.core.settings import ENV_PREFIX, Settings

ROOT = Path(__file__).parents[2]
UNIT = ROOT / "systemd" / "edgevox-agent.service"
QUADLET = ROOT / "systemd" / "edgevox.container"
COMPOSE = yaml.safe_load((ROOT / "docker-compose.ros2.yml").read_text(encoding="utf-8"))
ROBOT = COMPOSE["services"]["edgevox-ros2"]


def read(file: Path) -> dict[str, dict[str, list[str]]]:
    """The values of each section, all of a name that stands several times."""
    sections: dict[str, dict[str, list[str]]] = {}
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            section = sections.setdefault(line.strip("[]"), defaultdict(list))
        elif line and not line.startswith("#"):
            name, _, value = line.partition("=")
            section[name].append(value)
    return sections


def variables(section: dict[str, list[str]]) -> dict[str, str]:
    return dict(one.split("=", 1) for one in section["Environment"])


def default(text: str) -> str:
    """What compose takes where the shell has no such variable."""
    return text.partition(":-")[2].rstrip("}") if text.startswith("${") else text


def test_the_quadlet_has_the_limits_of_compose():
    container = read(QUADLET)["Container"]
    flags = dict(one.lstrip("-").split("=", 1) for one in container["PodmanArgs"][0].split())
    assert flags == {
        "memory": default(ROBOT["mem_limit"]),
        "memory-swap": default(ROBOT["memswap_limit"]),
        "cpus": default(ROBOT["cpus"]),
        "pids-limit": str(ROBOT["pids_limit"]),
        "shm-size": ROBOT["shm_size"].removesuffix("b"),
        "stop-timeout": default(ROBOT["stop_grace_period"]).removesuffix("s"),
    }
    health = ROBOT["healthcheck"]
    assert container["HealthCmd"] == [shlex.join(health["test"][1:])]
    assert container["HealthInterval"] == [health["interval"]]
    assert container["HealthTimeout"] == [health["timeout"]]
    assert container["HealthRetries"] == [str(health["retries"])]
    assert container["HealthStartPeriod"] == [health["start_period"]]
    assert container["Tmpfs"] == ROBOT["tmpfs"]
    assert container["DropCapability"] == [one.lower() for one in ROBOT["cap_drop"]]
    assert container["ReadOnly"] == container["NoNewPrivileges"] == ["true"]
    assert [one.partition(":")[2] for one in container["Volume"]] == ["/places"]
    given = variables(container)
    assert given == {name: default(ROBOT["environment"][name]) for name in given}


@pytest.mark.parametrize(("file", "section"), [(QUADLET, "Container"), (UNIT, "Service")])
def test_only_what_a_program_reads_is_set(file, section):
    settings = {f"{ENV_PREFIX}{name.upper()}" for name in Settings.model_fields}
    known = settings | set(ENVIRONMENT) | {"XDG_STATE_HOME", "ROS_LOG_DIR"}
    assert set(variables(read(file)[section])) <= known


@pytest.mark.parametrize(("file", "section"), [(QUADLET, "Container"), (UNIT, "Service")])
def test_neither_is_killed_while_it_drains(file, section):
    sections = read(file)
    drain_s = float(variables(sections[section])["EDGEVOX_DRAIN_S"])
    leave_s = Settings.model_fields["leave_s"].default
    assert float(sections["Service"]["TimeoutStopSec"][0]) > drain_s + leave_s


def test_the_units_command_starts_a_robot_and_ends_it(tmp_path):
    service = read(UNIT)["Service"]
    agent = str(Path(sys.executable).with_name("edgevox-agent"))
    own = {
        "EDGEVOX_AGENT": "robot-apartment",
        "EDGEVOX_ROS2": "false",
        "EDGEVOX_TEXT_MODE": "true",
        "EDGEVOX_LLM": "none",
        "EDGEVOX_HEALTH_PORT": "0",
        "XDG_STATE_HOME": str(tmp_path),
        "ROS_LOG_DIR": str(tmp_path),
    }
    environment = {**os.environ, **variables(service), **own}
    del environment["EDGEVOX_MODELS_DIR"]
    command = [
        part.replace("/opt/ros/jazzy/setup.bash", "/dev/null")
        .replace("/opt/edgevox/bin/edgevox-agent", agent)
        .replace("${EDGEVOX_AGENT}", own["EDGEVOX_AGENT"])
        for part in shlex.split(service["ExecStart"][0])
    ]
    with subprocess.Popen(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as robot:
        assert any("is ready" in line for line in robot.stdout)
        robot.terminate()
        robot.stdout.read()
        assert robot.wait(HUNG_S) == 0
