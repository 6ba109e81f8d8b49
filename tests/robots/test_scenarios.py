"""The example scenarios come true, on every robot that they are for."""

import subprocess
import sys
from pathlib import Path

import pytest
from guards import HUNG_S

from edgevox.apps.robots import ROBOTS
from edgevox.scenario import load_scenario

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
FILES = sorted((Path(__file__).parents[2] / "scenarios").glob("*.yaml"))
PLAYED = [(file, robot) for file in FILES for robot in load_scenario(file).agent]


@pytest.mark.parametrize(("file", "robot"), PLAYED, ids=lambda one: getattr(one, "stem", one))
def test_a_scenario_comes_true(file, robot):
    played = subprocess.run(
        [AGENT, robot, "--scenario", str(file)], capture_output=True, text=True, timeout=HUNG_S
    )
    assert played.returncode == 0, played.stdout + played.stderr


def test_every_robot_that_is_simulated_has_a_scenario():
    assert {robot for _, robot in PLAYED} == set(ROBOTS) - {"robot-external"}
