"""Sound by the host's sound server: a real one, a real container, sound that can be heard."""

import time

import pytest
from guards import HUNG_S
from sound_server import SoundServer, sound_server
from stacks import PATIENCE, Stack, stack
from waiting import wait_until

pytestmark = [pytest.mark.usefixtures("image"), pytest.mark.long]
SERVICE = "edgevox-ros2"
SAY = (PATIENCE, "/edgevox/state=speaking", "--say", "/edgevox/tts_request=Can you hear me now")


@pytest.fixture
def server(tmp_path):
    with sound_server(tmp_path / "pulse") as one:
        yield one


def speaks(robot: Stack, server: SoundServer) -> bool:
    """Whether the robot is heard; while it finds its loudspeaker it may have to be told again."""
    deadline = time.monotonic() + HUNG_S
    with server.heard() as loud:
        while time.monotonic() < deadline:
            assert robot.probe(SERVICE, *SAY)["found"]["/edgevox/state"]
            if loud.wait(5):
                return True
    return False


def is_open(server: SoundServer) -> bool:
    """Whether the robot's two streams are there: both wait for the sound server."""
    return wait_until(lambda: server.streams() == (1, 1), "two streams")


def test_a_robot_hears_and_speaks_by_the_sound_server_and_outlives_its_restart(server: SoundServer):
    with stack("audio-server", PULSE_FOLDER=str(server.folder), EDGEVOX_LLM="none") as robot:
        assert is_open(server)
        assert speaks(robot, server)
        started = robot.inspect(SERVICE)["State"]["StartedAt"]
        server.stop()
        server.start()
        assert speaks(robot, server)
        assert is_open(server)
        assert robot.inspect(SERVICE)["State"]["StartedAt"] == started
