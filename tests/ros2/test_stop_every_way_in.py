"""Stop means stop: every way to say it, whatever the robot is busy with, seen from outside.

How long a word takes to reach it is a figure of the benchmarks. Here it must stand soon after it
has let go of its goal, in its own time, before it has arrived, and the goal must end as canceled
for who asked for it.
"""

import phrases
import pytest
from halting import BRAKED_S, LEFT_M
from peer import Peer
from robot_states import moving, standing
from stop_rig import SITUATIONS, WAYS, Robot, settle


@pytest.fixture(scope="module")
def home(domain):
    robot = Robot(domain)
    yield robot
    robot.close()


@pytest.fixture
def robot(home):
    settle(home)
    return home


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("situation", SITUATIONS)
def test_it_stands(robot, situation, way):
    with SITUATIONS[situation](robot) as goal:
        since = len(robot.state.messages) - 1
        WAYS[way](robot, goal)
    assert robot.client.end_of(goal)[0] == "canceled"
    halt = robot.halted(since)
    assert halt.braked_s < BRAKED_S
    assert halt.left_m > LEFT_M


@pytest.mark.parametrize("way", ["text_input", "standard input", "command"])
def test_said_at_rest_twice_and_by_two_people_at_once_it_is_harmless(robot, domain, way):
    heard, words = len(robot.words.messages), 2 if way == "command" else 4
    second = Peer(domain)
    try:
        for _ in range(2):
            WAYS[way](robot, None)
            second.send("text_input", "stop")
        robot.words.wait_for(lambda m: m == "stop", since=heard + words - 1)
        settle(robot)
    finally:
        second.close()
    goal = robot.drives()
    WAYS[way](robot, goal)
    assert robot.client.end_of(goal)[0] == "canceled"


def test_a_drive_by_standard_input_is_stopped_by_the_line_after_it(robot):
    """And what comes after the stop is done."""
    robot.type("go to the bedroom" if robot.newest()["pose"]["x"] > 5 else "go to the kitchen")
    robot.state.wait_for(moving, since=len(robot.state.messages))
    robot.type("where are you")  # waits for the end of the drive
    heard, since = len(robot.sentence.messages), len(robot.state.messages) - 1

    robot.type("stop\nwhat is your battery level")

    robot.sentence.wait_for(lambda m: m == phrases.said("stopped"), since=heard)
    halt = robot.halted(since)
    assert halt.braked_s < BRAKED_S
    assert halt.left_m > LEFT_M
    robot.sentence.wait_for(lambda m: "percent" in m, since=heard)
    assert not any(m.startswith("I am in") for m in robot.sentence.messages[heard:])
    robot.agent.wait_for_line("[cancelled lines before this stop: 1]")
    assert standing(robot.state.messages[-1])
