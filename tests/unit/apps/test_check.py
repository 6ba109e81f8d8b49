"""`--check` of a robot file: all that is wrong, what is off, and sentences that can never work."""

from pathlib import Path

import pytest

from edgevox.agent.nlu.templates import Recogniser
from edgevox.agent.skills import Call, SkillSet
from edgevox.apps.agent.check import check_robot
from edgevox.apps.agent.main import main
from edgevox.apps.robots import build_body
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings

CALL = "call: {name: honk, type: std_srvs/srv/Trigger}"
EXTERNAL = "robot-external"
PAGE = Path(__file__).parents[3] / "docs" / "your-robot.md"


def written(tmp_path, text):
    file = tmp_path / "robot.yaml"
    file.write_text(text, "utf-8")
    return file


def skills(*entries):
    lines = (f"  {name}: {{description: Do it., {CALL}, {said}}}\n" for name, said in entries)
    return "skills:\n" + "".join(lines)


def checked(tmp_path, capsys, text):
    """Whether all is well, and what is told beside the skills."""
    settings = Settings(robot_file=written(tmp_path, text))
    well = check_robot(build_body(EXTERNAL, settings, 0.0), settings)
    return well, capsys.readouterr().err.splitlines()


def test_a_file_of_which_all_can_work_is_well(tmp_path, capsys):
    text = skills(("honk", "sentences: ['honk [now|please]']"), ("beep", "done: Beep."))
    assert checked(tmp_path, capsys, text) == (True, [])


def test_a_skill_of_long_templates_is_shown_by_its_plainest_sentence(tmp_path, capsys):
    long = "[please|could you please] (sound|honk|blow) [the] (horn|hooter|klaxon) [once|right now]"
    file = written(tmp_path, skills(("honk", f"sentences: ['{long}']")))
    assert main([EXTERNAL, "--robot-file", str(file), "--check"]) == 0
    assert "  honk: Do it. sound horn\n" in capsys.readouterr().out


def test_all_that_is_wrong_with_a_file_is_told_at_once_by_line(tmp_path, capsys):
    text = skills(
        ("two", "colour: red"),
        ("three", "request: {x: 1}, result: {y: z, w: message}"),
        ("four", "sentences: ['a (b', 'c {d}'], done: 'It is {e}.'"),
    )
    text += "  one: {description: One., call: {name: a, type: nowhere_msgs/srv/A}}\n"
    file = written(tmp_path, text)
    with pytest.raises(InvalidValue) as caught:
        build_body(EXTERNAL, Settings(robot_file=file), 0.0)
    assert [one.field.removeprefix("robot.yaml:") for one in caught.value.problems] == [
        "2: skills.two.colour",
        "3: skills.three.request.x",
        "3: skills.three.result.y",
        "4: skills.four.sentences.0",
        "4: skills.four.sentences.1",
        "4: skills.four.done",
        "5: skills.one",
    ]
    assert main([EXTERNAL, "--robot-file", str(file), "--check"]) == 2
    assert capsys.readouterr().err.count("robot.yaml:") == 7


def test_every_skill_whose_types_are_missing_is_named_and_the_check_fails(tmp_path, capsys):
    missing = "description: Do it., call: {name: a, type: nowhere_msgs/srv/A}"
    text = "skills:\n" + "".join(f"  s{n}: {{{missing}}}\n" for n in range(15))
    well, told = checked(tmp_path, capsys, text + f"  honk: {{description: Honk., {CALL}}}\n")
    assert not well
    off = [line for line in told if " is off: nowhere_msgs cannot be imported" in line]
    assert [line.split()[0] for line in off if line.startswith("s")] == [f"s{n}" for n in range(15)]


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        ("emergency", "'emergency', which stops the robot"),
        ("unlock the protective stop", "'stop', which stops the robot"),
        ("yes", "it answers the robot"),
        ("lift by 10 centimetres", "understood"),
        ("honk [now|twice]", "it asks for other"),
    ],
)
def test_a_sentence_that_can_never_work_is_told_by_its_line(tmp_path, capsys, sentence, expected):
    other = ("other", "sentences: ['honk twice']")
    text = skills(other, ("honk", f"sentences: ['sound the horn', '{sentence}']"))
    well, told = checked(tmp_path, capsys, text)
    assert not well
    (line,) = told
    assert line.startswith("robot.yaml:3: skills.honk.sentences.1: got")
    assert expected in line


def test_a_number_with_a_unit_that_is_heard_otherwise_is_told(tmp_path, capsys):
    text = (
        "skills: {lift: {description: Lift., publish: {name: lift, type: std_msgs/msg/Float64},"
        " request: {data: '{x}'}, arguments: {x: {type: number, min: 0, max: 2}},"
        " sentences: ['lift {x} UNIT']}}"
    )
    assert checked(tmp_path, capsys, text.replace("UNIT", "metres"))[0]
    for said in ("lift 10 centimetres", "lift 0.1 m", "lift 0.1 metres"):
        settings = Settings(robot_file=written(tmp_path, text.replace("UNIT", "(metre|m)")))
        lift = SkillSet(build_body(EXTERNAL, settings, 0.0).skills)
        assert Recogniser(lift).recognise(said).calls == (Call("lift", {"x": 0.1}),)
    well, (line,) = checked(tmp_path, capsys, text.replace("UNIT", "centimetres"))
    assert not well
    assert "'lift 1 centimetres'" in line


def test_a_sentence_without_a_required_argument_is_told_with_the_argument(tmp_path, capsys):
    text = (
        "skills: {hover: {description: Hover., publish: {name: mode, type: std_msgs/msg/String},"
        " request: {data: '{mode}'}, arguments: {mode: {type: choice, values: {loiter: L},MORE}},"
        " sentences: ['change to {mode}', 'hover [now]']}}"
    )
    assert checked(tmp_path, capsys, text.replace("MORE", " default: loiter"))[0]
    well, (line,) = checked(tmp_path, capsys, text.replace("MORE", ""))
    assert not well
    assert "skills.hover.sentences.1: got 'hover" in line
    assert "{mode}" in line


def test_a_need_that_an_old_message_can_meet_is_noted(tmp_path, capsys):
    state = "state: {up: {topic: up, type: std_msgs/msg/Bool, field: data, LATCHED}}\n"
    needs = "needs: [{state: up, equals: true, failed: Get up.}]\n"
    text = state + needs + skills(("honk", needs.strip()))
    assert checked(tmp_path, capsys, text.replace(", LATCHED", "")) == (True, [])
    well, told = checked(tmp_path, capsys, text.replace("LATCHED", "latched: true"))
    assert well
    assert [line.partition(" is latched")[0] for line in told] == [
        "note: robot.yaml:2: needs.0: up",
        "note: robot.yaml:4: skills.honk.needs.0: up",
    ]


def test_a_sentence_in_another_language_is_checked_in_that_language(tmp_path, capsys):
    german = "sentences: [honk], languages: {de: {sentences: [hup mal, halt die Klappe auf]}}"
    well, (line,) = checked(tmp_path, capsys, skills(("honk", german)))
    assert not well
    assert line.startswith("robot.yaml:2: skills.honk.languages.de.sentences.1: got 'halt die")


def test_an_exact_sentence_wins_over_a_drive_and_the_check_tells(tmp_path, capsys):
    places = "places: {kitchen: {x: 1.0, y: 1.0}}\n"
    own = "sentences: ['go to the kitchen'], languages: {de: {sentences: [fahr in die Küche]}}"
    well, told = checked(tmp_path, capsys, places + skills(("honk", own)))
    assert well
    assert [line.partition(": ")[0] for line in told] == ["note", "note"]
    assert "'go to the kitchen' no longer asks for navigate_to" in told[0]
    assert "skills.honk.languages.de.sentences.0: 'fahr in die Küche'" in told[1]


@pytest.mark.parametrize("part", ["state", "sentences-that-work"])
def test_what_the_page_shows_is_well(tmp_path, capsys, part):
    parts = PAGE.read_text("utf-8").split("\n### ")
    (shown,) = (one for one in parts if one.partition("\n")[0].lower().replace(" ", "-") == part)
    well, told = checked(tmp_path, capsys, shown.split("```yaml\n")[1].split("```")[0])
    assert well
    assert all(line.startswith("note: ") and " is latched" in line for line in told)


STATES = """state:
  door:
    topic: door
    type: std_msgs/msg/Bool
    field: data
    when:
      - {equals: true, sentences: ["[the] door is (open|ajar)"]}
      - {equals: false, sentences: ["you SAID"]}
  warmth: {topic: temperature, type: sensor_msgs/msg/Temperature, field: temperature, unit: degrees}
"""


def test_what_orders_can_wait_for_is_shown(tmp_path, capsys):
    file = written(tmp_path, STATES.replace("SAID", "shut the door"))
    assert main([EXTERNAL, "--robot-file", str(file), "--check"]) == 0
    waits = capsys.readouterr().out.partition("orders can wait until:\n")[2].splitlines()
    assert waits[:3] == [
        "  the door is open",
        "  you shut the door",
        "  the warmth is above {value} degrees",
    ]


def test_a_condition_that_would_stop_the_robot_is_told(tmp_path, capsys):
    well, told = checked(tmp_path, capsys, STATES.replace("SAID", "stop"))
    assert not well
    assert told == [
        "state.door.when: got 'you stop', expected a sentence without 'stop', which stops the robot"
    ]


@pytest.mark.parametrize(
    ("condition", "told"),
    [
        ("above: 1", "state.door.when.1: got 'door', expected a number, to be above or below"),
        ("equals: 3", "state.door.when.1.equals: got 3"),
        ("equals: true, below: '{value}'", "{value} in each of the sentences"),
        ("{}", "equals, above or below"),
    ],
)
def test_a_condition_that_its_state_cannot_meet_is_refused(tmp_path, condition, told):
    text = STATES.replace("equals: false", condition).replace("{}, ", "")
    with pytest.raises(InvalidValue) as caught:
        build_body(EXTERNAL, Settings(robot_file=written(tmp_path, text)), 0.0)
    assert told in str(caught.value)
