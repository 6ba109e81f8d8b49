"""Robots that other packages bring: found by their entry points, broken ones among them."""

import sys
from pathlib import Path

import pytest

from edgevox.agent.intents import Recogniser, Understood
from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.skills import Call, SkillSet
from edgevox.apps.robot import GROUP, Robot, installed_robots
from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import load_settings

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Makes a package whose entry point names this, out of these lines."""
    monkeypatch.syspath_prepend(tmp_path)

    def make(value, code=""):
        about = tmp_path / "someone-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: someone\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text(f"[{GROUP}]\nrobot-someones = {value}\n")
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
        "from edgevox.apps.robot import Robot\nMINE = Robot('mine', lambda settings, speed: speed)",
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


def test_what_is_there_already_is_not_replaced(install):
    install("someones_robot:MINE")
    assert "robot-someones" not in installed_robots(besides={"robot-someones"})


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
    assert german.abilities([patrol]) == "Ich kann: einen Rundgang durch alle Räume machen."
    french = phrasebook("fr")
    assert french.acknowledge(patrol, {"rounds": 1}) == "Going on my round."
