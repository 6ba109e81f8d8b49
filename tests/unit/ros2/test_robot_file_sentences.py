"""Sentences that a robot file makes of shared lists and rules, as long as an order takes."""

from pathlib import Path

import pytest

from edgevox.agent.nlu.meaning import StateIs, When
from edgevox.agent.nlu.order_reader import ProgramReader
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.skills import SkillSet
from edgevox.apps.agent.check import check_robot
from edgevox.apps.robots import build_body
from edgevox.core.settings import Settings

EXAMPLES = Path(__file__).parents[3] / "examples" / "robot_file"


@pytest.fixture(scope="module")
def machine():
    return build_body("robot-external", Settings(robot_file=EXAMPLES / "coffee.yaml"), 0.0)


@pytest.mark.parametrize(
    ("code", "order", "arguments"),
    [
        ("en", "coffee", {"drink": "coffee"}),
        (
            "en",
            "can I get a big dark roast one shot flat white with lots of milk and no sugar",
            {"size": "large", "roast": "dark", "shots": "single", "milk": "lots of"}
            | {"drink": "latte"},
        ),
        (
            "en",
            "I'd like a medium roasted small mocha, without milk and a bit of sugar",
            {"roast": "medium", "size": "small", "drink": "mocha", "sugar": "a little"},
        ),
        ("en", "pour me a triple espresso", {"shots": "triple", "drink": "espresso"}),
        ("de", "mach mir einen großen Cappuccino bitte", {"size": "large", "drink": "cappuccino"}),
    ],
)
def test_an_order_has_its_parts_in_any_sequence(machine, code, order, arguments):
    found = Recogniser(SkillSet(machine.skills), code).recognise(order)
    assert isinstance(found, Understood)
    assert [(one.skill, one.arguments) for one in found.calls] == [("make_coffee", arguments)]


def test_a_percent_sign_is_heard_as_the_word(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(
        "drives: false\nskills:\n  dim:\n    description: Dim the lamp.\n    moves: false\n"
        "    arguments: {level: {type: integer, min: 0, max: 100}}\n"
        "    publish: {name: lamp, type: std_msgs/msg/Int32}\n    request: {data: '{level}'}\n"
        "    sentences: ['dim to {level} percent']\n"
        "    languages: {de: {sentences: ['dimme auf {level} Prozent']}}\n"
    )
    skills = SkillSet(build_body("robot-external", Settings(robot_file=file), 0.0).skills)
    for code, said in (("en", "dim to 50%"), ("en", "dim to 50 %."), ("de", "dimme auf 50%")):
        found = Recogniser(skills, code).recognise(said)
        assert isinstance(found, Understood), said
        assert found.calls[0].arguments == {"level": 50}


def test_what_only_begins_like_an_order_is_none(machine):
    heard = Recogniser(SkillSet(machine.skills), "en")
    assert not isinstance(heard.recognise("make me a large table"), Understood)


def test_all_sentences_of_the_order_can_work(machine, capsys):
    assert check_robot(machine, Settings(robot_file=EXAMPLES / "coffee.yaml"))
    assert capsys.readouterr().err == ""


def test_an_order_waits_for_a_length_in_any_unit(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(
        "state:\n  height: {topic: h, type: std_msgs/msg/Float64, field: data, unit: metres}\n"
        "skills:\n  dance: {description: Dance., call: {name: d, type: std_srvs/srv/Trigger}}\n"
    )
    body = build_body("robot-external", Settings(robot_file=file), 0.0)
    skills = Recogniser(SkillSet(body.skills), "en")

    def plain(text):
        found = skills.recognise(text)
        return found.calls if isinstance(found, Understood) else found

    for said, metres in (("40 centimetres", 0.4), ("2 metres", 2.0), ("0.5", 0.5)):
        order = ProgramReader("en", body.conditions).read(
            f"when the height is above {said}, dance", plain
        )
        assert isinstance(order, When)
        assert isinstance(order.condition, StateIs)
        assert order.condition.value == metres
