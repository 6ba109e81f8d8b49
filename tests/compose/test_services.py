"""What overlays give a robot: a recorder, models on a volume, a language model on a server."""

import os
import secrets
from pathlib import Path
from shutil import copytree

import pytest
from guards import HUNG_S
from llm_server import good, serving
from stacks import PATIENCE, Stack, count_messages, docker, stack
from waiting import wait_until

from edgevox.models.store import default_root

pytestmark = [pytest.mark.usefixtures("image"), pytest.mark.long]
SERVICE = "edgevox-ros2"
STATE = "/edgevox/robot_state"
KEY = "a-key-that-nobody-sees"
MODEL = "micro-wake-words"
ENOUGH_BYTES = 100_000


def test_a_recorder_on_the_hosts_network_hears_a_robot_there(tmp_path):
    domain = str(secrets.randbelow(90) + 10)
    ports = {"EDGEVOX_HEALTH_PORT": "18001", "ROS_DOMAIN_ID": domain, "EDGEVOX_LLM": "none"}
    with stack("recorder", "host", **ports) as one:

        def records() -> bool:
            sizes = one.execute(
                "recorder", "bash", "-c", "cat $(find /recordings -name '*.mcap.open') | wc -c"
            )
            return int(sizes) > ENOUGH_BYTES

        wait_until(records, "that it records")
        one.call("stop", "recorder")
        one.call("cp", "recorder:/recordings", str(tmp_path))
    counted = count_messages(tmp_path)
    assert counted[STATE] > 10
    assert counted["/tf"] > 30


def test_a_server_is_asked_with_the_key_that_a_secret_holds(tmp_path):
    key = tmp_path / "llm.key"
    key.write_text(KEY + "\n")
    key.chmod(0o644)  # whoever runs the tests need not have the container's uid
    with serving(good("?"), host="0.0.0.0") as server:  # noqa: S104 - containers come from outside
        given = {
            "EDGEVOX_LLM": "none",
            "EDGEVOX_LLM_ENDPOINT": f"http://host.docker.internal:{server.port}",
            "EDGEVOX_LLM_ENDPOINT_MODEL": "the-fleets-own",
            "LLM_KEY_FILE": str(key),
        }
        with stack("llm", "llm-key", **given) as robot:
            ask = "/edgevox/text_input=why does ice float"
            robot.probe(SERVICE, PATIENCE, "/edgevox/response", "--say", ask)
            wait_until(lambda: bool(server.keys), "a request")
            assert KEY not in str(robot.inspect(SERVICE))
            assert KEY not in robot.logs(SERVICE)
    assert set(server.keys) == {f"Bearer {KEY}"}
    assert {one["model"] for one in server.asked} == {"the-fleets-own"}


def test_the_slim_image_takes_its_models_from_a_volume(image):
    given = {"EDGEVOX_IMAGE": f"{image}-slim", "MODEL_SET": MODEL, "EDGEVOX_LLM": "none"}
    with stack("models", start=False, **given) as robot:
        _fill(robot, image)
        up = robot.call("up", "--detach", "--wait", "--no-build", timeout=HUNG_S)
        assert robot.inspect("models")["State"]["ExitCode"] == 0
        assert robot.inspect(SERVICE)["State"]["Health"]["Status"] == "healthy", up.stderr
        assert up.returncode == 0, up.stderr
        said = robot.execute(SERVICE, "edgevox-models", "verify", MODEL)
        assert f"{MODEL}: right" in said
        wrote = robot.call("exec", "-T", SERVICE, "touch", "/models/mark")
        assert "Read-only file system" in wrote.stderr


def test_models_are_verified_before_the_robot_has_them_and_bad_ones_change_nothing(image, tmp_path):
    """From a folder, without the network, each onto a volume of its own."""
    good, bad = tmp_path / "good", tmp_path / "bad"
    for folder in (good, bad):
        copytree(default_root() / MODEL, folder / MODEL)
    damage(bad / MODEL)
    volume = f"edgevox-test-{secrets.token_hex(4)}"
    given = {"EDGEVOX_IMAGE": f"{image}-slim", "MODEL_SET": MODEL, "EDGEVOX_LLM": "none"}
    given |= {"EDGEVOX_OFFLINE": "true", "MODELS_VOLUME": f"{volume}-1", "MODELS_FROM": str(good)}
    with stack("models", start=False, **given) as robot:
        up = robot.call("up", "--detach", "--wait", "--no-build", timeout=HUNG_S)
        assert up.returncode == 0, up.stderr
        before = robot.inspect(SERVICE)
        changed = os.environ | {"MODELS_VOLUME": f"{volume}-2", "MODELS_FROM": str(bad)}
        fill = ("run", "--rm", "--no-deps", "-T", "models")
        ran = robot.call(*fill, env=changed, timeout=HUNG_S)
        docker("volume", "rm", f"{volume}-2")
        assert ran.returncode == 1
        assert f"folder /given/{MODEL}: " in ran.stderr
        assert "is missing or damaged" in ran.stderr
        after = robot.inspect(SERVICE)
        assert after["Id"] == before["Id"]
        assert after["State"]["Health"]["Status"] == "healthy"
        assert f"{MODEL}: right" in robot.execute(SERVICE, "edgevox-models", "verify")


def damage(folder: Path) -> None:
    """One byte of one file is another."""
    file = max(
        (one for one in folder.rglob("*") if one.is_file()), key=lambda one: one.stat().st_size
    )
    data = bytearray(file.read_bytes())
    data[-1] ^= 1
    file.write_bytes(bytes(data))


def _fill(robot: Stack, image: str) -> None:
    """Put a model onto the volume, as a fetch does where a network is."""
    made = robot.call("run", "--rm", "--no-deps", "-T", "models", "true", timeout=HUNG_S)
    assert made.returncode == 0, made.stderr
    copy = ("cp", "-r", f"/opt/edgevox/models/{MODEL}", "/models/")
    docker("run", "--rm", f"--volume={robot.project}_models:/models", "--entrypoint=", image, *copy)
