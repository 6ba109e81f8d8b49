"""The example scenarios come true, on every robot that they are for."""

from pathlib import Path

import pytest
from agent_here import run_agent

from edgevox.apps.robots import ROBOTS
from edgevox.scenario import load_scenario

FILES = sorted((Path(__file__).parents[2] / "scenarios").glob("*.yaml"))
PLAYED = [(file, robot) for file in FILES for robot in load_scenario(file).agent]
SLOW = "robot-irsim"


@pytest.mark.parametrize(
    ("file", "robot"),
    [
        pytest.param(
            *one, marks=pytest.mark.long if one[1] == SLOW else (), id=f"{one[0].stem}-{one[1]}"
        )
        for one in PLAYED
    ],
)
def test_a_scenario_comes_true(file, robot):
    played = run_agent(robot, "--scenario", str(file))
    assert played.returncode == 0, played.stdout + played.stderr


def test_every_robot_that_is_simulated_has_a_scenario():
    assert {robot for _, robot in PLAYED} == set(ROBOTS) - {"robot-external"}
