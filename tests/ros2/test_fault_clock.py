"""Clocks that jump: the machine's, under a real process, and /clock, which a rosbag sets back."""

import contextlib
import json
import struct
import subprocess
import time
from pathlib import Path

import phrases
import pytest
from external_rig import wheels
from geometry_msgs.msg import PoseStamped, Twist
from guards import HUNG_S
from interop_rig import Messages, Stream, hear, tell, twist
from peer import SENSOR, STATE, Peer
from robot_states import moving, standing
from rosgraph_msgs.msg import Clock
from waiting import Heard, wait_until

pytestmark = pytest.mark.long

WALL_CLOCK_C = Path(__file__).with_name("wall_clock.c")
OFFSET = struct.Struct("<q")
HOUR_S = 3600
NEAR_S = 60.0
WATCHDOG_S, SLACK_S = 0.5, 60.0
"""The slack is for velocities that are still on their way on a busy machine: a watchdog that a jump
misleads is off by hours."""


class WallClock:
    """The wall clock of processes that are started `running` by it; their monotonic one is real."""

    def __init__(self, folder, monkeypatch):
        self._file, self._monkeypatch = folder / "offset_s", monkeypatch
        self._library = folder / "wall_clock.so"
        subprocess.run(
            ["cc", "-O2", "-shared", "-fPIC", "-o", self._library, WALL_CLOCK_C, "-ldl"], check=True
        )
        self._file.write_bytes(bytes(OFFSET.size))

    def jump_to(self, offset_s):
        with self._file.open("r+b") as file:
            file.write(OFFSET.pack(offset_s))

    @contextlib.contextmanager
    def running(self):
        with self._monkeypatch.context() as patch:
            patch.setenv("LD_PRELOAD", str(self._library))
            patch.setenv("WALL_CLOCK", str(self._file))
            yield


@pytest.fixture
def wall_clock(tmp_path, monkeypatch):
    return WallClock(tmp_path, monkeypatch)


def stamped(message):
    return message.header.stamp.sec + message.header.stamp.nanosec / 1e9


def turning(message):
    return abs(json.loads(message)["velocity"]["angular"]) > 0.1


class Driven:
    """What a peer hears of a robot and how it drives it."""

    def __init__(self, peer: Peer) -> None:
        self.peer = peer
        self.response = peer.listen("response")
        self.state: Heard = peer.listen("robot_state", STATE)
        self._velocity = tell(peer, Twist, peer.name("cmd_vel"), SENSOR)

    def waits(self, wanted, timeout_s=HUNG_S):
        return self.state.wait_for(wanted, timeout_s, since=len(self.state.messages))

    def says(self, text, part):
        heard = len(self.response.messages)
        self.peer.send("text_input", text)
        self.response.wait_for(lambda m: part in m, 60.0, since=heard)

    def is_watched(self):
        """It follows velocities, and halts soon after the last one."""
        stream = Stream(self._velocity, twist(0.0, 0.8))
        self.waits(turning)
        stream.end()
        last = json.loads(self.state.messages[-1])
        stood = json.loads(self.waits(standing))
        assert stood["time"] - last["time"] < WATCHDOG_S + SLACK_S, "of its own time"


def stamps_are_at(poses: Messages, offset_s):
    """Newly sent stamps are those of a clock that is so far off."""
    since = len(poses.messages)
    poses.wait_for(lambda m: abs(stamped(m) - time.time() - offset_s) < NEAR_S, 20.0, since)


def test_a_wall_clock_that_jumps_by_hours_moves_stamps_and_nothing_else(agent, peer, wall_clock):
    with wall_clock.running():
        one = agent()
    robot = Driven(peer())
    poses = hear(robot.peer, PoseStamped, "/edgevox/pose")
    stamps_are_at(poses, 0)
    robot.says("go to the bedroom", "bedroom")
    robot.waits(moving)
    for offset_s in (3 * HOUR_S, -5 * HOUR_S):
        wall_clock.jump_to(offset_s)
        stamps_are_at(poses, offset_s)
        robot.waits(moving)  # the drive goes on
    robot.says("stop", "Stopped")
    robot.waits(standing)
    robot.is_watched()
    robot.says("go to the living room", phrases.done("navigate_to", room="living_room"))
    wall_clock.jump_to(0)
    stamps_are_at(poses, 0)
    robot.is_watched()
    assert not [line for line in one.lines if "Traceback" in line]


def test_a_clock_topic_that_is_set_back_moves_stamps_and_nothing_else(agent, peer):
    agent("--ros-args", "-p", "use_sim_time:=true")
    robot = Driven(peer())
    poses = hear(robot.peer, PoseStamped, "/edgevox/pose")
    tick = tell(robot.peer, Clock, "/clock", SENSOR)
    robot.says("go to the bedroom", "bedroom")
    for seconds in (5000, 9000, 100):
        now = Clock()
        now.clock.sec = seconds
        stream = Stream(tick, now)
        poses.wait_for(lambda m, s=seconds: stamped(m) == pytest.approx(s, abs=1))
        robot.waits(moving)
        stream.end()  # and it stands still
    robot.says("stop", "Stopped")
    robot.waits(standing)
    robot.is_watched()


@pytest.mark.parametrize("sim_s", [(), (9000, 100)], ids=["no clock at all", "set back"])
def test_a_robot_of_others_is_driven_and_stopped_whatever_the_clock_does(
    agent, peer, domain, sim_s
):
    with wheels(domain=domain, namespace="/robot1"):
        agent(
            *("--namespace=/robot1", "--max-linear=0.6"),
            *("--ros-args", "-p", "use_sim_time:=true"),
            robot="robot-external",
        )
        one = peer()
        state = one.listen("robot_state", STATE)
        state.wait_for(lambda m: json.loads(m)["pose"] is not None)
        one.send("text_input", "go to x 20 y 0")
        tick = tell(one, Clock, "/clock", SENSOR) if sim_s else None
        for seconds in sim_s:
            now = Clock()
            now.clock.sec = seconds
            for _ in range(5):
                tick(now)
                state.wait_for(lambda _: True, since=len(state.messages))
        state.wait_for(moving, 20.0, since=len(state.messages))
        one.send("interrupt", "")
        state.wait_for(standing, 5.0, since=len(state.messages))
        wait_until(lambda: json.loads(state.messages[-1])["goal"] is None, "no goal")
