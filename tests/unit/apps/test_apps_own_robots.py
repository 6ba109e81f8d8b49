"""Robots that other packages bring: found by their entry points, broken ones among them."""

import sys
import tomllib
from pathlib import Path

import pytest

from edgevox.agent.nlu.abilities import abilities
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call, SkillSet
from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import load_settings
from edgevox.robots import bundled
from edgevox.robots.plugin import GROUP, Robot, installed_robots

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples"


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Makes a package whose entry point names this, out of these lines."""
    monkeypatch.syspath_prepend(tmp_path)

    def make(value, code="", name="robot-someones"):
        about = tmp_path / "someone-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: someone\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text(f"[{GROUP}]\n{name} = {value}\n")
        (tmp_path / "someones_robot.py").write_text(code)
        monkeypatch.delitem(sys.modules, "someones_robot", raising=False)

    return make


@pytest.fixture
def patrol(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES / "own_skill")
    import watchman

    return watchman.patrol_skill(None)


def test_an_installed_package_brings_its_robot(install):
    install(
        "someones_robot:MINE",
        "from edgevox.robots.plugin import Robot\n"
        "MINE = Robot('mine', lambda settings, speed: speed)",
    )
    mine = installed_robots()["robot-someones"]
    assert mine.about == "mine"
    assert mine.build(load_settings({}), 2.0) == 2.0


@pytest.mark.parametrize(
    ("value", "code", "said"),
    [
        ("someones_robot:MINE", "", "AttributeError"),
        ("someones_robot:MINE", "raise OSError('no driver')", "OSError: no driver"),
        ("someones_robot:MINE", "MINE = 3", "someones_robot:MINE is no Robot"),
        ("not_here_at_all:MINE", "", "ModuleNotFoundError"),
    ],
)
def test_a_broken_package_says_so_only_when_its_robot_is_asked_for(install, value, code, said):
    install(value, code)
    broken = installed_robots()["robot-someones"]
    assert isinstance(broken, Robot)
    with pytest.raises(EdgeVoxError, match=said):
        broken.build(load_settings({}), None)


def test_a_package_is_not_loaded_until_its_robot_is_looked_at(install):
    install("someones_robot:MINE", "raise SystemExit('loaded')")
    assert "robot-someones" in list(installed_robots())


def test_a_robot_of_ours_is_not_replaced(install):
    install("someones_robot:MINE", name="robot-apartment")
    assert installed_robots()["robot-apartment"] is bundled.APARTMENT


def test_ours_are_found_as_those_of_others_are():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    assert set(declared[GROUP]) <= set(installed_robots())
    assert isinstance(installed_robots()["robot-external"], Robot)


def test_a_checkout_that_nobody_installed_has_our_robots(monkeypatch):
    monkeypatch.setattr(sys, "path", [])
    assert list(installed_robots()) == [
        "robot-apartment",
        "robot-external",
        "robot-humanoid",
        "robot-irsim",
        "robot-panda",
    ]


def test_the_project_of_somebody_else_beside_the_package_brings_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "path", [])
    project = tmp_path / "pyproject.toml"
    project.write_text("[project]\nname = 'theirs'\n")
    assert list(installed_robots(project)) == []


def test_no_example_imports_the_programs():
    for example in EXAMPLES.rglob("*.py"):
        assert "edgevox.apps" not in example.read_text(), example


@pytest.mark.parametrize(
    ("language", "sentence", "arguments"),
    [
        ("en", "do your round please", {}),
        ("en", "patrol the rooms three times", {"rounds": 3.0}),
        ("de", "Mach bitte zwei Rundgänge.", {"rounds": 2.0}),
        ("de", "Sieh bitte nach dem Rechten", {}),
        ("fr", "do two rounds", {"rounds": 2.0}),
    ],
)
def test_a_skill_brings_its_own_words(patrol, language, sentence, arguments):
    found = Recogniser(SkillSet([patrol]), language).recognise(sentence)
    assert found == Understood((Call("patrol", arguments),))


def test_a_skill_is_spoken_of_in_its_own_words(patrol):
    german = phrasebook("de")
    assert german.acknowledge(patrol, {"rounds": 1}) == "Ich mache meinen Rundgang."
    assert german.report(patrol, {}, {"seen": 4}) == "Ich habe 4 Räume gesehen, alles ist ruhig."
    assert abilities(german, [patrol])[0] == "Ich kann: einen Rundgang durch alle Räume machen."
    french = phrasebook("fr")
    assert french.acknowledge(patrol, {"rounds": 1}) == "Going on my round."
