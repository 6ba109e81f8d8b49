"""The robots that there are: what each needs is in the manifest, and missed in words that help."""

import sys
from pathlib import Path

import pytest

from edgevox.apps.robots import ROBOTS, build_agents, build_body
from edgevox.core.settings import load_settings
from edgevox.models import ModelMissing
from edgevox.models.manifest import builtin_manifest
from edgevox.robots.plugin import FOR_BODIES, INSTRUCTIONS

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
MODELLED = [name for name, robot in ROBOTS.items() if robot.models]


def test_a_robot_that_needs_models_has_a_set_of_them_that_make_run_fetches():
    sets = builtin_manifest().sets
    makefile = (Path(__file__).parents[3] / "Makefile").read_text()
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


@pytest.mark.parametrize(
    ("name", "given", "unread"),
    [
        ("robot-apartment", {"locations": "places.yaml"}, ["locations"]),
        ("robot-apartment", {"world": "hall.yaml", "seed": 3}, []),
        ("robot-external", {"locations": "places.yaml", "max_linear": 0.2}, []),
        ("robot-external", {"mjcf": "robot.xml"}, ["mjcf"]),
        ("robot-humanoid", {"mjcf": "robot.xml", "world": "hall.yaml"}, ["world"]),
        ("robot-panda", {"seed": 3, "world": "a.yaml", "max_linear": 0.2}, ["max_linear", "world"]),
    ],
)
def test_a_robot_knows_which_settings_do_nothing_for_it(name, given, unread):
    assert ROBOTS[name].unread(load_settings(given)) == unread


def test_who_sets_what_does_nothing_for_the_robot_is_told(caplog):
    build_body("robot-apartment", load_settings({"locations": "places.yaml"}), 0.0)
    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert record.msg["setting"] == "locations"
    assert record.msg["robot"] == "robot-apartment"


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_of_ours_says_which_settings_it_reads(name):
    assert ROBOTS[name].reads is not None
    assert ROBOTS[name].reads <= FOR_BODIES


def test_whoever_talks_for_a_body_has_its_skills_and_its_instructions():
    body = build_body("robot-apartment", load_settings({}), 0.0)
    (agent,) = build_agents(body)
    assert list(agent.skills) == [skill.name for skill in body.skills]
    assert agent.instructions == INSTRUCTIONS
