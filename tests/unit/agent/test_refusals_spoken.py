import re
from contextlib import closing
from dataclasses import replace
from threading import Event
from typing import Annotated

import pytest
from guards import HUNG_S
from pydantic import Field
from support.bodies import SKILLS
from support.body import FakeBody
from support.conversation import Talk

from edgevox.agent.nlu.abilities import abilities, not_understood
from edgevox.agent.nlu.templates import Recogniser, RefusedCommand
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import detail
from edgevox.agent.skills import OneOf, SkillFailed, SkillPhrases, SkillSet, reason_of, skill
from edgevox.agent.skills.failures import WrongArgument
from edgevox.apps.terminal.view import View
from edgevox.core.agent_events import GoalCancelled, as_json
from edgevox.core.commands import Reset, TextInput
from edgevox.core.languages import LANGUAGES

PLACES = ("kitchen", "bedroom", "office", "garage", "hallway", "entrance", "cellar", "attic")
STOPPED = phrasebook("en").say("stopped")
WRONG = (1e6, -1e6, 0.5, True, "nonsense", None, [1.0])


def refusals():
    """What is wrong with each argument of each skill, for values of every kind; and without any."""
    for name, one in SKILLS.items():
        for argument in one.arguments_model.model_fields:
            for value in WRONG:
                yield name, one, {argument: value}
        yield name, one, {}
        yield name, one, {"height_m": 5.0}


def raised():
    for name, one, arguments in refusals():
        try:
            one.validate(arguments)
        except (WrongArgument, SkillFailed) as error:
            yield name, arguments, reason_of(error)


@pytest.mark.parametrize("code", LANGUAGES)
def test_what_is_wrong_with_an_argument_is_said_in_the_words_of_the_language(code):
    book, english = phrasebook(code), phrasebook("en")
    heard = set()
    for name, arguments, why in raised():
        said = book.refusal(why)
        heard.add(why.code)
        assert why.code, (name, arguments)
        assert code == "en" or said != english.refusal(why), said
        assert not set("{}_[]") & set(said), said
        assert name.partition(".")[2] not in said, said
        assert not re.search(r"height m\b", said), said
    assert {"too_large", "too_small", "no_number", "missing_argument", "not_one_of"} <= heard


def test_what_is_only_written_stands_on_the_screen():
    lines = []
    with Talk(FakeBody(rooms=PLACES)) as talk, closing(View(talk.bus, lines.append, lambda: None)):
        talk.say("go to the celery")

    assert "cellar and attic" not in talk.said[-1]
    assert "cellar and attic" in lines[-1]


def test_programs_get_a_code_with_every_goal_that_is_cancelled():
    with Talk() as talk:
        talk.begin("go to the kitchen and go to the office")
        talk.begin("walk 2 metres")
        talk.say("stop")
        talk.begin("walk 3 metres")
        talk.conversation.submit(Reset())
        talk.settle()

    cancelled = [as_json(one) for one in talk.of(GoalCancelled)]
    assert {(one["skill"], one.get("code")) for one in cancelled} == {
        ("navigate_to", "preempted"),
        ("navigate_to", "step_ended"),
        ("walk_forward", "heard_stop"),
        ("walk_forward", "reset"),
    }


ODD = "zorkblat"
"""No word of any language: an argument that is called so can only be spoken by mistake."""


def own_skill(**more):
    """A skill of one's own with arguments of every kind, called as no language calls anything."""
    modes = OneOf(("soft", "hard"))

    @skill(templates=["do {zorkblat_mode} {zorkblat_m}"], **more)
    def work(
        goal,
        zorkblat_mode: Annotated[str, modes],
        zorkblat_m: Annotated[float, Field(ge=0.0, le=2.0)],
        zorkblat: Annotated[int, Field(ge=1, le=5)] = 1,
        zorkblat_flag: bool = False,
    ):
        """Do some work."""

    return work


def what_is_said_of(one, book):
    """All that people may hear of a skill: what it can do, asks, begins, ends and refuses."""
    usual = {"zorkblat_mode": "soft", "zorkblat_m": 1.0}
    yield book.can(one)
    yield book.question([(one, usual)])
    yield book.acknowledge(one, usual)
    yield book.report(one, usual, {})
    yield from abilities(book, [one] * 6)
    yield from filter(None, not_understood(book, [one]))
    calls = [{**usual, name: value} for name in one.arguments_model.model_fields for value in WRONG]
    for arguments in (*calls, {}, {"zorkblat_m": 1.0}, {**usual, "zorkblat_x": 5.0}):
        try:
            one.validate(arguments)
        except (WrongArgument, SkillFailed) as error:
            yield book.refusal(reason_of(error))
            yield detail(book, reason_of(error))


@pytest.mark.parametrize("code", LANGUAGES)
def test_what_an_argument_is_called_in_python_is_never_spoken(code):
    one = own_skill()
    said = [*what_is_said_of(one, phrasebook_of(code, [one]))]
    recogniser = Recogniser(SkillSet([one]), code)
    heard = [recogniser.recognise(text) for text in ("do sulky 1", "do")]
    said += [found.reason for found in heard if isinstance(found, RefusedCommand)]

    assert len(said) > 30
    assert not [text for text in said if ODD in text.casefold()]


@pytest.mark.parametrize("code", LANGUAGES)
def test_an_argument_is_spoken_as_its_skill_calls_it_in_the_language(code):
    called = SkillPhrases(arguments={"zorkblat": "GIVEN NAME"})
    one = own_skill(phrases={code: called})
    with pytest.raises(WrongArgument) as caught:
        one.validate({"zorkblat_mode": "soft", "zorkblat_m": 1.0, "zorkblat": 9})

    assert "GIVEN NAME" in phrasebook_of(code, [one]).refusal(reason_of(caught.value))


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_argument_of_our_skills_has_a_name_in_every_language(code):
    book = phrasebook(code)
    for name, one in SKILLS.items():
        for argument in one.arguments_model.model_fields:
            said = book.argument(argument)
            assert len(argument) == 1 or said != book.argument("nobody knows it"), (name, argument)
            assert "_" not in said


class Unready:
    """A robot whose dance may not be able to begin; `waits` lets it look for as long as it may."""

    def __init__(self):
        self.body = FakeBody()
        self.why = SkillFailed("the floor is wet")
        self.waits = False
        self.looked = []
        self.looking = Event()
        names = ("navigate_to", "dance", "open_door", "get_pose", "stop")
        some = self.body.skills(*names)
        dance = replace(some["dance"], ready=self.ready)
        self.skills = SkillSet([dance if name == "dance" else some[name] for name in names])

    def ready(self, token, most_s):
        self.looked.append(most_s)
        self.looking.set()
        if self.waits:
            token.wait()
            token.check()
        if self.why:
            raise self.why


@pytest.fixture
def unready():
    robot = Unready()
    with Talk(robot.body, skills=robot.skills) as talk:
        yield robot, talk


def test_an_order_that_cannot_begin_leaves_alone_what_the_robot_does_and_promises_nothing(unready):
    robot, talk = unready
    talk.begin("go to the kitchen")
    assert "the floor is wet" in talk.ask("do your dance")
    goals = {one["skill"]: one["status"] for one in talk.told("skill_goal")}
    assert goals == {"navigate_to": "running", "dance": "rejected"}
    robot.body.arrive()
    talk.until_said("I am in the kitchen.")
    assert robot.body.sent == ["kitchen"]
    assert "Dancing." not in talk.said


def test_a_program_and_an_action_that_cannot_begin_leave_it_alone_too(unready):
    robot, talk = unready
    talk.begin("go to the kitchen")
    for begin in (talk.conversation.check_goal, talk.conversation.start_goal):
        with pytest.raises(SkillFailed, match="wet"):
            begin("dance", {})
    assert "the floor is wet" in talk.ask("do your dance three times")
    assert robot.looked == [0.0] * len(robot.looked), "neither may block"
    assert talk.conversation.moving
    assert "cancelled" not in [one["status"] for one in talk.told("skill_goal")]


def test_only_the_first_of_some_orders_has_to_be_able_to_begin(unready):
    robot, talk = unready
    robot.body.quick = True
    talk.say("go to the kitchen and then do your dance")
    assert robot.body.visited[:1] == ["kitchen"]


def test_a_stop_ends_the_look_whether_it_can_begin(unready):
    robot, talk = unready
    robot.waits = True
    talk.conversation.submit(TextInput("do your dance"))
    assert robot.looking.wait(HUNG_S)
    talk.conversation.submit(TextInput("stop"))
    talk.settle()
    assert not robot.body.sent


def test_what_fails_once_it_has_ended_another_motion_says_that_this_has_ended(unready):
    _, talk = unready
    talk.begin("go to the kitchen")
    talk.say("open the door")
    assert talk.said[-1] == f"I could not do that: the door is locked. {STOPPED}"
    talk.say("open the door")
    assert talk.said[-1] == "I could not do that: the door is locked."
