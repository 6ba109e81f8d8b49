"""The robots that there are: what each needs is in the manifest, and missed in words that help."""

import sys
from pathlib import Path

import pytest

from edgevox.apps.robots import ROBOTS, build_agents, build_body
from edgevox.core.settings import load_settings
from edgevox.models import ModelMissing
from edgevox.models.manifest import builtin_manifest
from edgevox.robots.plugin import INSTRUCTIONS

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
MODELLED = [name for name, robot in ROBOTS.items() if robot.models]


def test_a_robot_that_needs_models_has_a_set_of_them_that_make_run_fetches():
    sets = builtin_manifest().sets
    makefile = (Path(__file__).parents[2] / "Makefile").read_text()
    (line,) = (one for one in makefile.splitlines() if "fetch small $(filter" in one)
    for name, robot in ROBOTS.items():
        assert (name in sets) == bool(robot.models) == (name in line)
        assert set(robot.models) <= set(sets.get(name, ()))


@pytest.mark.parametrize("name", MODELLED)
def test_a_model_that_is_missing_is_said_with_the_command_that_fetches_it(
    name, tmp_path, monkeypatch
):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    with pytest.raises(ModelMissing, match=f"edgevox-models fetch {ROBOTS[name].models[0]}"):
        build_body(name, load_settings({}))


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_is_told_what_it_is(name):
    robot = ROBOTS[name]
    assert robot.about
    assert robot.instructions.startswith("You are EdgeVox")
    assert (robot.instructions == INSTRUCTIONS) == (not robot.models)


def test_whoever_talks_for_a_body_has_its_skills_and_its_instructions():
    body = build_body("robot-apartment", load_settings({}), 0.0)
    (agent,) = build_agents(body)
    assert list(agent.skills) == [skill.name for skill in body.skills]
    assert agent.instructions == INSTRUCTIONS
