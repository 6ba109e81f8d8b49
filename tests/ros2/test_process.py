"""The agent as a process: how it starts, what it refuses, how it ends."""

import glob
import os
import sys
from pathlib import Path

from agent_process import AGENT, READY, WITHOUT_ROS2, Agent
from guards import HUNG_S, run_program
from peer import STATE
from robot_states import moving

SHARED_MEMORY = "/dev/shm/fastrtps"  # noqa: S108 - where the middleware puts it


def shared_memory_of(process):
    """The middleware's shared memory that this process has open, its peers' included."""
    maps = Path(f"/proc/{process.pid}/maps").read_text(encoding="utf-8")
    return {line.split()[-1] for line in maps.splitlines() if SHARED_MEMORY in line}


def test_it_lives_without_a_terminal_and_leaves_after_sigterm_while_the_robot_drives(agent, peer):
    haunted = set(glob.glob(f"{SHARED_MEMORY}*"))  # by processes that other tests killed
    one = agent("--ros-args", "--log-level", "debug")
    assert "ROS 2: /edgevox/edgevox" in one.output
    robot = peer()
    state = robot.listen("robot_state", STATE)
    robot.send("text_input", "go to the bedroom")
    state.wait_for(moving)
    segments = shared_memory_of(one.process) - haunted
    assert segments
    assert one.terminate() == 0
    robot.close()
    assert not [name for name in segments if os.path.exists(name)]
    assert "Traceback" not in one.output


def test_a_bad_namespace_ends_the_process_with_its_reason(domain):
    bad = run_program([AGENT, "robot-apartment", "--text-mode", "--ros2-namespace", "my robot"])
    assert bad.returncode == 2
    assert "agent_namespace: got 'my robot', expected a ROS 2 namespace" in bad.stderr


def test_a_middleware_that_is_not_there_ends_the_process_with_its_reason(domain, monkeypatch):
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_nowhere_cpp")
    one = Agent("robot-apartment", "--text-mode", "--ros2", "--llm", "none", domain=domain)
    assert one.process.wait(HUNG_S) != 0
    one.terminate()
    assert READY not in one.output
    assert "rmw_nowhere_cpp" in one.output


def test_without_ros2_one_line_says_so_and_the_agent_works():
    flags = ["robot-apartment", "--text-mode", "--ros2", "--llm=none"]
    done = run_program([sys.executable, "-c", WITHOUT_ROS2, *flags], input="where are you\n")
    assert done.returncode == 0
    assert "ROS 2: off, since rclpy cannot be imported" in done.stdout
    assert "I am in the" in done.stdout
