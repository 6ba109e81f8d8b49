"""The doctor lists plug-ins and packages with robots and skills, and says what does not load."""

import pytest
from doctor_rig import ERROR, OK, SKIPPED, WARNING, situation

from edgevox.apps.doctor.robots import judge_packages, probe_packages

SKILLS = "def make(context):\n    return []\n"
ROBOT = "from edgevox.robots.plugin import Robot\nROBOT = Robot('a robot', lambda *_: None)\n"


def package(place, name, code, *points):
    """One as pip unpacks it into a folder: its module and its entry points, each with its group."""
    about = place / f"{name}-1.2.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n")
    lines = [f"[edgevox.{group}]\n{point} = {name}:{what}\n" for group, point, what in points]
    (about / "entry_points.txt").write_text("".join(lines))
    (place / f"{name}.py").write_text(code)


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "plugins"
    made.mkdir()
    return made


def told(**settings):
    """What is said, each with its level."""
    asked = situation(**settings)
    said = judge_packages(probe_packages(asked), asked)
    return [(one.level, one.found) for one in said]


def test_every_plug_in_is_listed_with_what_it_brings(folder):
    package(folder / "lift", "a_lift", SKILLS, ("skills", "lift", "make"))
    package(folder / "van", "a_van", ROBOT, ("robots", "robot-van", "ROBOT"))
    said = told(plugins=folder)
    assert said[:2] == [(OK, "plug-in lift: a_lift 1.2"), (OK, "plug-in van: a_van 1.2")]
    assert (OK, "robot robot-van, of a_van") in said
    assert (OK, "skills of lift, of a_lift") in said


def test_what_does_not_load_is_an_error_with_its_reason(folder):
    (folder / "torn-1.0-py3-none-any.whl").write_text("no archive")
    package(folder / "lift", "a_lift", "raise OSError('no driver')", ("skills", "lift", "make"))
    package(folder / "van", "a_van", "ROBOT = 3", ("robots", "robot-van", "ROBOT"))
    errors = [found for level, found in told(plugins=folder) if level is ERROR]
    assert errors[0].startswith("plug-in torn-1.0-py3-none-any.whl: ")
    assert errors[1:] == [
        "robot robot-van, of a_van: a_van:ROBOT is no Robot",
        "skills of lift, of a_lift: OSError: no driver",
    ]


def test_skills_that_are_not_chosen_are_told_and_not_missed(folder):
    package(folder / "lift", "a_lift", "raise OSError('no driver')", ("skills", "lift", "make"))
    said = told(plugins=folder, skills="none")
    assert (SKIPPED, "skills of lift, of a_lift") in said
    assert all(level is not ERROR for level, _ in said)


def test_of_two_packages_with_one_name_the_one_that_is_left_out_is_told(folder):
    package(folder / "one", "a_lift", SKILLS, ("skills", "lift", "make"))
    package(folder / "two", "b_lift", SKILLS, ("skills", "lift", "make"))
    expected = "skills of lift, of b_lift, are left out: a_lift also has that name"
    assert (WARNING, expected) in told(plugins=folder)


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"plugins": "/nope"}, "plugins: got '/nope', expected a folder"),
        ({"skills": "lifft"}, "skills: got 'lifft', expected one of "),
    ],
)
def test_a_setting_with_which_no_agent_starts_is_an_error(settings, expected):
    ((level, found),) = told(**settings)
    assert level is ERROR
    assert found.startswith(expected)


def test_where_skills_are_not_there_a_broken_plug_in_that_may_have_them_is_told_too(folder):
    (folder / "lift-1.0-py3-none-any.whl").write_text("no archive")
    missing, torn = told(plugins=folder, skills="lift")
    assert missing == (ERROR, "skills: got 'lift', expected one of all, none")
    assert torn[1].startswith("plug-in lift-1.0-py3-none-any.whl: ")


def test_a_package_that_ends_the_process_is_a_finding_and_the_others_are_told(folder):
    package(folder / "van", "a_van", "raise SystemExit(3)", ("robots", "robot-van", "ROBOT"))
    package(folder / "lift", "a_lift", SKILLS, ("skills", "lift", "make"))
    said = told(plugins=folder)
    assert (ERROR, "robot robot-van, of a_van: SystemExit: 3") in said
    assert (OK, "skills of lift, of a_lift") in said
