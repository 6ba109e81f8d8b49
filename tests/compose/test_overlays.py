"""Every overlay is a compose file that makes sense on the one below it."""

import itertools
import json
import os
import re
import subprocess
from pathlib import Path, PurePosixPath

import pytest
import yaml
from stacks import BASE, ROOT

from edgevox.apps.container import ENVIRONMENT, prepared

pytestmark = pytest.mark.long

OVERLAYS = sorted((ROOT / "compose").glob("*.yml"))
NAMES = [file.stem for file in OVERLAYS]
TABLE = "<!-- table: overlays"
KEYSTORE = "EDGEVOX_SECURITY_KEYSTORE"


def _excluded() -> dict[str, set[str]]:
    """What docs/deployment.md says does not go together, by overlay."""
    page = (ROOT / "docs" / "deployment.md").read_text().partition(TABLE)[2]
    rows = [line.split("|")[1:-1] for line in page.partition("\n\n")[0].splitlines()[3:]]
    not_with: dict[str, set[str]] = {name: set() for name in NAMES}
    for file, _, words in rows:
        (name,) = re.findall(r"`([\w-]+)\.yml`", file)
        named = set(re.findall(r"`([\w-]+)\.yml`", words))
        for other in set(NAMES) - {name} - named if "all but" in words else named:
            not_with[name].add(other)
            not_with[other].add(name)
    assert [name for name in NAMES if f"`{name}.yml`" not in "".join(r[0] for r in rows)] == []
    return not_with


NOT_WITH = _excluded()
PAIRS = [pair for pair in itertools.combinations(NAMES, 2) if pair[1] not in NOT_WITH[pair[0]]]


def _config(*overlays: str, file: str = "") -> dict:
    """The services of the base with these overlays, and with a file of one's own."""
    command = ["docker", "compose", "-f", BASE]
    command += itertools.chain.from_iterable(("-f", f"compose/{name}.yml") for name in overlays)
    command += ["-f", file] if file else []
    command += ["--profile", "*", "config", "--format", "json"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert "warn" not in ran.stderr.lower()
    return json.loads(ran.stdout)


def _is_hardened(services: dict) -> None:
    for name, service in services.items():
        assert service["read_only"], name
        assert service["cap_drop"] == ["ALL"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        for limit in ("mem_limit", "cpus", "pids_limit", "restart"):
            assert service[limit], f"{name}: {limit}"
        assert service["logging"]["options"]["max-size"], name


@pytest.mark.parametrize("overlay", OVERLAYS, ids=lambda file: file.stem)
def test_an_overlay_fits_on_the_base(overlay):
    services = _config(overlay.stem)["services"]
    assert "edgevox-ros2" in services
    _is_hardened(services)


@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_overlays_that_go_together_do_so_in_any_order(pair):
    services = _config(*pair)["services"]
    _is_hardened(services)
    assert _sorted(services) == _sorted(_config(*reversed(pair))["services"])


def _sorted(value: object) -> object:
    """The same with lists in an order that says nothing."""
    if isinstance(value, dict):
        return {key: _sorted(one) for key, one in value.items()}
    return sorted(map(_sorted, value), key=json.dumps) if isinstance(value, list) else value


def test_what_does_not_go_together_is_a_choice_and_no_habit():
    assert len(PAIRS) > 4 * len(NAMES)
    assert {name for name in NAMES if len(NOT_WITH[name]) > 4} == {"fleet"}


def test_many_overlays_go_together():
    services = _config("host", "recorder", "audio", "dev", "gpu", "llm", "llm-key")["services"]
    robot = services["edgevox-ros2"]
    assert robot["network_mode"] == "host"
    assert robot["devices"]
    assert robot["volumes"]
    assert robot["secrets"] == [{"source": "llm_key", "target": "/run/secrets/llm_key"}]


def test_hearing_and_speech_are_on_this_machine_unless_another_is_named(monkeypatch):
    def endpoints():
        given = _config("speech", "speech-key")["services"]["edgevox-ros2"]["environment"]
        return given["EDGEVOX_STT_ENDPOINT"], given["EDGEVOX_TTS_ENDPOINT"]

    here = "tcp://host.docker.internal"
    assert endpoints() == (f"{here}:10300", f"{here}:10200")
    monkeypatch.setenv("EDGEVOX_STT_ENDPOINT", "http://speech:8000")
    monkeypatch.setenv("EDGEVOX_TTS_ENDPOINT", "")
    assert endpoints() == ("http://speech:8000", "")


def test_the_policy_is_a_file_in_a_folder_that_is_mounted():
    """Of a file that is mounted by itself, another one in its place would not be seen."""
    robot = _config("policy")["services"]["edgevox-ros2"]
    (mount,) = (one for one in robot["volumes"] if "policy" in one["target"])
    assert (mount["type"], mount["read_only"]) == ("bind", True)
    assert robot["environment"]["EDGEVOX_POLICY"] == f"{mount['target']}/policy.yaml"


def test_each_service_has_its_own_enclave_read_only_where_the_entrypoint_looks():
    services = _config("secure", "recorder")["services"]
    for service, folder in {"edgevox-ros2": "robot", "recorder": "recorder"}.items():
        (mount,) = (m for m in services[service]["volumes"] if m["source"].endswith(f"/{folder}"))
        assert (mount["type"], mount["read_only"]) == ("bind", True)
        assert mount["source"] == str(ROOT / "security" / folder)
        given = services[service]["environment"]
        assert given["EDGEVOX_SECURITY_KEYSTORE"] == mount["target"]


def test_the_robots_enclave_is_not_given_to_the_recorder(monkeypatch):
    monkeypatch.setenv("EDGEVOX_SECURITY_ENCLAVE", "/anna/robot")
    services = _config("secure", "recorder")["services"]
    given = {name: one["environment"]["EDGEVOX_SECURITY_ENCLAVE"] for name, one in services.items()}
    assert given == {"edgevox-ros2": "/anna/robot", "recorder": ""}
    monkeypatch.setenv("SECURITY_RECORDER_ENCLAVE", "/anna/recorder")
    recorder = _config("secure", "recorder")["services"]["recorder"]
    assert recorder["environment"]["EDGEVOX_SECURITY_ENCLAVE"] == "/anna/recorder"


def test_a_fleet_is_secured_as_the_page_says(tmp_path):
    page = (
        (ROOT / "docs" / "security.md").read_text().partition("A fleet of `compose/fleet.yml`")[2]
    )
    shown = page.partition("```yaml\n")[2].partition("```")[0]
    file = tmp_path / "fleet-security.yml"
    file.write_text(shown)
    robots = _config("fleet", file=str(file))["services"]
    secured = {name for name, one in robots.items() if one["environment"].get(KEYSTORE)}
    assert secured == {"robot1", "robot2", "robot3"}
    for name in secured:
        (mount,) = (m for m in robots[name]["volumes"] if m["source"].endswith(f"/{name}"))
        assert (mount["target"], mount["read_only"]) == (
            robots[name]["environment"][KEYSTORE],
            True,
        )


def test_the_console_is_published_on_this_machine_only_unless_it_is_said(monkeypatch):
    def published():
        robot = _config("console")["services"]["edgevox-ros2"]
        (port,) = robot["ports"]
        assert str(port["target"]) == robot["environment"]["EDGEVOX_CONSOLE_PORT"]
        return port["host_ip"], port["published"]

    assert published() == ("127.0.0.1", "8443")
    monkeypatch.setenv("CONSOLE_ADDRESS", "192.168.1.20")
    monkeypatch.setenv("CONSOLE_PORT", "443")
    assert published() == ("192.168.1.20", "443")


def test_who_is_paired_with_the_console_is_kept_on_a_volume():
    robot = _config("console")["services"]["edgevox-ros2"]
    (mount,) = (one for one in robot["volumes"] if one["source"] == "console")
    assert robot["environment"]["EDGEVOX_CONSOLE_FOLDER"] == mount["target"]
    assert f" {mount['target']} " in (ROOT / "docker" / "add_user").read_text()


@pytest.mark.parametrize("user", ["recorder", "smoke"])
def test_the_recorder_is_where_the_robot_is(user):
    """Or else it hears nothing: on the same network, by the same discovery."""
    alone = _config(user)["services"]
    assert alone["recorder"].get("profiles") is None
    host = _config(user, "host")["services"]["recorder"]
    assert host["network_mode"] == "host"
    assert host["environment"]["FASTDDS_BUILTIN_TRANSPORTS"] == "UDPv4"
    discovery = _config(user, "discovery")["services"]
    server = discovery["edgevox-ros2"]["environment"]["ROS_DISCOVERY_SERVER"]
    assert discovery["recorder"]["environment"]["ROS_DISCOVERY_SERVER"] == server


def test_no_container_swaps():
    for overlay in NAMES:
        for name, service in _config(overlay)["services"].items():
            limit = service.get("memswap_limit", service["mem_limit"])
            assert limit == service["mem_limit"], f"{overlay}: {name}"


def test_the_health_check_is_the_images():
    """Written twice, since images in OCI's format lose it."""
    lines = (ROOT / "Dockerfile.ros2").read_text().replace("\\\n", " ").splitlines()
    (line,) = (line for line in lines if line.startswith("HEALTHCHECK"))
    of_image = dict(re.findall(r"--([\w-]+)=(\w+)", line))
    of_compose = yaml.safe_load((ROOT / BASE).read_text())["services"]["edgevox-ros2"][
        "healthcheck"
    ]
    asked = json.loads(line[line.index("CMD") + 3 :])
    # Only where /tmp is new at each start, and a policy restarts what ended.
    assert [*asked, "--end-frozen"] == of_compose.pop("test")[1:]
    assert {name.replace("-", "_"): value for name, value in of_image.items()} == {
        name: str(value) for name, value in of_compose.items()
    }


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
        "EDGEVOX_AGENT_NAMESPACE",
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
        mounted = {one["target"] for one in service.get("volumes") or ()}
        given = {k: v for k, v in (service.get("environment") or {}).items() if v is not None}
        given |= {k: str(tmp_path) for k, v in given.items() if v in mounted}
        for name, value in given.items():
            if str(PurePosixPath(value).parent) in mounted:  # a file in a mounted folder
                given[name] = str(tmp_path / PurePosixPath(value).name)
                Path(given[name]).touch()
        prepared(given, pytest.fail)
        assert {name for name in given if name.startswith("EDGEVOX_")} <= set(ENVIRONMENT)
