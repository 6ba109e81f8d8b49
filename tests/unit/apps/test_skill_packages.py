"""Skills that packages bring to any robot: found by entry points, broken ones among them."""

import logging
import sys
from pathlib import Path

import pytest

from edgevox.apps.agent.check import check_robot
from edgevox.apps.agent.main import parse_arguments
from edgevox.apps.robots import build_agents, build_body, gather_skills
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import load_settings
from edgevox.robots.skill_packages import SKILL_GROUP, SkillContext

EXAMPLE = Path(__file__).parents[3] / "examples" / "own_ros_skill"
WAVE = """
from edgevox.agent.skills import Skill, skill

def make(context):
    @skill(templates=["{template}"])
    def {name}(goal):
        '''Wave.'''
        return {{"places": len(context.places)}}

    return [{name}]
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Makes a package with these modules, whose entry points have their names."""
    monkeypatch.syspath_prepend(tmp_path)

    def make(package="brought", **modules):
        about = tmp_path / f"{package}-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
        points = "\n".join(f"{name} = {package}_{name}:make" for name in modules)
        (about / "entry_points.txt").write_text(f"[{SKILL_GROUP}]\n{points}\n")
        for name, code in modules.items():
            (tmp_path / f"{package}_{name}.py").write_text(code)
            monkeypatch.delitem(sys.modules, f"{package}_{name}", raising=False)

    return make


def wave(name="wave_hand", template="wave your hand"):
    return WAVE.format(name=name, template=template)


def gathered(**settings):
    asked = load_settings(settings)
    body = build_body("robot-apartment", asked, 0.0)
    return body, gather_skills(body, asked).skills


def names(skills):
    return [one.name for one in skills]


def told(caplog, event):
    return [record.msg for record in caplog.records if record.msg["event"] == event]


def test_an_installed_package_brings_its_skills_to_a_robot_of_ours(install):
    install(greeter=wave())
    body, skills = gathered()
    assert names(skills) == [*names(body.skills), "wave_hand"]
    (agent,) = build_agents(body, skills)
    assert agent.skills["wave_hand"].function(None) == {"places": len(body.places)}


@pytest.mark.parametrize(
    ("chosen", "has"),
    [
        ("all", {"wave_hand", "bow"}),
        ("none", set()),
        ("greeter", {"wave_hand"}),
        ("greeter, other", {"wave_hand", "bow"}),
    ],
)
def test_a_setting_says_which_packages_are_used(install, chosen, has):
    install(greeter=wave(), other=wave("bow", "take a bow"))
    assert {"wave_hand", "bow"} & set(names(gathered(skills=chosen)[1])) == has


def test_a_package_that_is_not_installed_is_refused_with_those_that_are(install):
    install(greeter=wave())
    with pytest.raises(InvalidValue, match="skills: got 'greter', expected one of .*greeter"):
        gathered(skills="greter")


@pytest.mark.parametrize(
    "code",
    [
        "raise ValueError('no driver')",
        "raise SystemExit(3)",
        "",
        "make = 3",
        "def make(context): raise OSError('no port')",
        "def make(context): return [print]",
        "def make(context): return 7",
    ],
)
def test_a_broken_package_is_told_by_name_and_keeps_nobody_else_from_working(install, caplog, code):
    install(alpha=code, greeter=wave())
    body, skills = gathered()
    assert names(skills) == [*names(body.skills), "wave_hand"]
    (line,) = told(caplog, "skill_package_broken")
    assert line["package"] == "alpha"


@pytest.mark.parametrize(
    ("name", "template", "reason"),
    [
        ("navigate_to", "go there", "a name that this robot's skills do not have yet"),
        ("wave_first", "wave", "a name that this robot's skills do not have yet"),
        ("halt_now", "halt now", "which stops the robot in English"),
        (
            "point_at",
            "point at {nothing}",
            "point_at.templates: got 'nothing', expected an argument",
        ),
        ("bow_low", "bow (low", "bow (low"),
        ("wink", "<eyes> wink", "eyes"),
    ],
)
def test_a_skill_that_cannot_be_is_refused_by_name_and_the_others_work(
    install, caplog, name, template, reason
):
    install(first=wave("wave_first"), second=wave(name, template), third=wave())
    body, skills = gathered()
    assert names(skills) == [*names(body.skills), "wave_first", "wave_hand"]
    (line,) = told(caplog, "skill_refused")
    assert (line["skill"], line["package"]) == (name, "second")
    assert reason in line["reason"]


def test_of_two_packages_with_one_name_the_first_is_used_and_the_other_is_told(install, caplog):
    install("zebra", greeter=wave("jump_up", "jump up"), other=wave("bow", "take a bow"))
    install("apple", greeter=wave())
    body, skills = gathered()
    assert names(skills) == [*names(body.skills), "wave_hand", "bow"]
    (line,) = told(caplog, "skill_package_twice")
    assert (line["package"], line["used"], line["left_out"]) == ("greeter", "apple", "zebra")
    caplog.clear()
    gathered(skills="other")
    assert not told(caplog, "skill_package_twice")


def test_skills_that_need_ros_2_are_off_without_it_which_is_told(install, caplog):
    install(porter="def make(context): return [context.require_ros()]", greeter=wave())
    body, skills = gathered()
    assert names(skills) == [*names(body.skills), "wave_hand"]
    (line,) = told(caplog, "skill_package_off")
    assert line["package"] == "porter"
    assert "--ros2" in line["reason"]


def test_the_example_is_off_without_ros_2(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLE)
    import dock_hand

    from edgevox.robots.skill_packages import SkillsOff

    context = SkillContext("dock-hand", build_body("robot-apartment", load_settings({}), 0.0), None)
    with pytest.raises(SkillsOff, match="robot-external"):
        dock_hand.dock_hand_skills(context)


def test_what_a_package_logs_is_shown_as_the_agents_own_lines_are(install, caplog):
    caplog.set_level(logging.INFO, logger="edgevox")
    install(greeter="def make(context):\n    context.log.info('made')\n    return []")
    gathered()
    (record,) = (one for one in caplog.records if one.msg["event"] == "made")
    assert record.name == "edgevox.skills.greeter"


def test_help_names_the_packages_and_what_is_broken(install, capsys):
    install(greeter=wave(), porter="raise OSError('no driver')")
    with pytest.raises(SystemExit):
        parse_arguments(["--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert (
        "Packages with skills: greeter, porter (installed, but broken: OSError: no driver)" in said
    )


def test_a_check_tells_what_the_policy_names_and_the_robot_has_not(install, capsys, tmp_path):
    install(greeter=wave())
    file = tmp_path / "policy.yaml"
    file.write_text(
        "rules: {voice: {wave_hand: deny, waves_hands: deny}}\n"
        "limits: {places: {never: [the kitchens, kichen]}}"
    )
    settings = load_settings({"policy": str(file)})
    assert check_robot(build_body("robot-apartment", settings, 0.0), settings)
    told = [line for line in capsys.readouterr().out.splitlines() if "names what" in line]
    assert [line.rpartition("has not: ")[2] for line in told] == [
        "waves_hands: no such skill; did you mean wave_hand?",
        "kichen: no such place; did you mean kitchen?",
    ]


def test_a_check_shows_the_skills_of_packages(install, capsys):
    install(greeter=wave())
    settings = load_settings({})
    assert check_robot(build_body("robot-apartment", settings, 0.0), settings)
    assert "wave_hand: Wave. wave your hand" in capsys.readouterr().out
