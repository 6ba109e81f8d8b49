"""Every overlay is a compose file that makes sense on the one below it."""

import itertools
import json
import os
import subprocess

import pytest
from stacks import BASE, ROOT

from edgevox.apps.container import ENVIRONMENT, prepared

OVERLAYS = sorted((ROOT / "compose").glob("*.yml"))
TOGETHER = ["host", "recorder", "audio", "dev", "gpu"]


def _config(*overlays: str) -> dict:
    command = ["docker", "compose", "-f", BASE]
    command += itertools.chain.from_iterable(("-f", f"compose/{name}.yml") for name in overlays)
    command += ["--profile", "*", "config", "--format", "json"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert "warn" not in ran.stderr.lower()
    return json.loads(ran.stdout)


@pytest.mark.parametrize("overlay", OVERLAYS, ids=lambda file: file.stem)
def test_an_overlay_fits_on_the_base(overlay):
    services = _config(overlay.stem)["services"]
    assert "edgevox-ros2" in services
    for name, service in services.items():
        assert service["read_only"], name
        assert service["cap_drop"] == ["ALL"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        assert service["mem_limit"], name
        assert service["restart"], name


def test_overlays_can_be_combined():
    service = _config(*TOGETHER)["services"]["edgevox-ros2"]
    assert service["network_mode"] == "host"
    assert service["devices"]
    assert service["volumes"]


def test_without_arguments_compose_finds_the_file():
    command = ["docker", "compose", "config", "--services"]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("COMPOSE_")}
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=environment)
    assert ran.stdout == "edgevox-ros2\n"


def test_each_robot_of_the_fleet_has_a_domain_a_namespace_and_a_health_port_of_its_own():
    services = _config("fleet")["services"]
    robots = [services[name]["environment"] for name in ("robot1", "robot2", "robot3")]
    for own in (
        "ROS_DOMAIN_ID",
        "EDGEVOX_NAMESPACE",
        "EDGEVOX_FRAME_PREFIX",
        "EDGEVOX_HEALTH_PORT",
    ):
        assert len({one[own] for one in robots}) == 3, own


@pytest.mark.parametrize("overlay", OVERLAYS, ids=lambda file: file.stem)
def test_what_an_overlay_sets_the_entrypoint_takes(overlay, monkeypatch, tmp_path):
    index = tmp_path / "share/ament_index/resource_index/rmw_typesupport"
    index.mkdir(parents=True)
    (index / "rmw_fastrtps_cpp").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    for service in _config(overlay.stem)["services"].values():
        given = {k: v for k, v in (service.get("environment") or {}).items() if v is not None}
        prepared(given, pytest.fail)
        assert {name for name in given if name.startswith("EDGEVOX_")} <= set(ENVIRONMENT)
