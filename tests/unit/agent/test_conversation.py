import threading

import phrases
import pytest
from logs_rig import logging_to_memory
from support.body import ROOMS, FakeBody
from support.conversation import Eloquent, Talk

from edgevox.agent.agents import Agent
from edgevox.agent.inbox import MAX_WAITING
from edgevox.agent.llm.protocol import SAY
from edgevox.agent.skills import SkillSet
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Interrupt, Reset, RunSkill, Speak, TextInput
from edgevox.core.events import (
    Responded,
    StateChanged,
    TokenGenerated,
    TurnMeasured,
)
from edgevox.ops.logs.setup import MOST_LINES

ROOMS_SAID = "kitchen, living room, bedroom and office"
UNKNOWN_ROOM = phrases.said("unknown_word", argument="room", said="garage", known=ROOMS_SAID)
SKILLS = ("navigate_to", "open_door", "get_pose")


class StoryTeller(Eloquent):
    """A model that tells an endless story, one token whenever the test allows it."""

    def __init__(self):
        self.allowed = threading.Semaphore(0)
        self.begun = threading.Event()

    def generate(self, messages, *, grammar, max_tokens, token):
        self.begun.set()
        yield SAY
        forget = token.on_cancel(self.allowed.release)
        while self.allowed.acquire(timeout=60) and not token.cancelled:
            yield "Once upon a time. "
        forget()


class Rig(Talk):
    """A conversation whose drives end when the test says."""

    def __init__(self, **more):
        super().__init__(FakeBody(), skills=SKILLS, clock=SystemClock(), **more)
        self.conversation.start()

    def say(self, text):
        self.conversation.submit(TextInput(text))

    def texts(self):
        return self.said

    def states(self):
        return [str(one.state) for one in self.of(StateChanged)]

    def agent_events(self):
        return [(one["kind"], one.get("status")) for one in self.events]


@pytest.fixture
def open_rig():
    rigs = []

    def make(**parts):
        rigs.append(Rig(**parts))
        return rigs[-1]

    yield make
    for rig in rigs:
        rig.conversation.close()
    names = {thread.name for thread in threading.enumerate()}
    assert not [n for n in names if n.startswith(("edgevox-conversation", "edgevox-goals"))]


@pytest.fixture
def rig(open_rig):
    return open_rig()


def test_a_command_is_acknowledged_at_once_and_reported_when_done(rig):
    rig.say("go to the kitchen")
    rig.body.starts()
    rig.body.arrive()
    rig.settle()
    assert rig.texts() == ["Going to the kitchen.", "I am in the kitchen."]
    assert rig.agent_events() == [
        ("tool_call", None),
        ("skill_goal", "accepted"),
        ("skill_goal", "running"),
        ("skill_goal", "succeeded"),
    ]
    assert rig.states() == [
        "listening",
        "thinking",
        "speaking",
        "listening",
        "speaking",
        "listening",
    ]


def test_the_robot_answers_a_question_while_it_drives(rig):
    rig.say("go to the kitchen")
    rig.body.starts()
    answered = threading.Event()
    rig.bus.subscribe(Responded, lambda e: answered.set() if "1.2" in e.text else None)
    rig.say("where are you")
    assert answered.wait(60)
    assert rig.body.moving
    rig.body.arrive()
    rig.settle()


def test_a_failed_skill_is_said_with_its_reason(rig):
    rig.say("open the door")
    rig.settle()
    assert rig.texts()[-1] == phrases.said("failed", reason="the door is locked")


@pytest.mark.parametrize("word", ["stop", "Halt!", "no, freeze"])
def test_a_stop_word_halts_the_body_and_says_so(rig, word):
    rig.say("go to the kitchen")
    rig.body.starts()
    rig.say(word)
    assert not rig.body.moving
    rig.settle()
    assert rig.texts()[-1] == phrases.said("stopped")
    assert ("safety_preempt", None) in rig.agent_events()
    assert ("skill_cancelled", "cancelled") in rig.agent_events()
    assert "interrupted" in rig.states()
    assert rig.states()[-1] == "listening"


def test_stop_does_not_wait_for_a_busy_model(open_rig):
    model = StoryTeller()
    rig = open_rig(model=model)
    rig.say("go to the kitchen")
    rig.body.starts()
    rig.say("tell me a story")
    assert model.begun.wait(60)
    rig.say("stop")
    assert not rig.body.moving
    rig.settle()
    assert rig.texts()[-1] == phrases.said("stopped")


def test_an_interrupted_answer_is_marked_as_cut_and_the_next_turn_is_clean(open_rig):
    model = StoryTeller()
    rig = open_rig(model=model)
    heard = threading.Event()
    rig.bus.subscribe(TokenGenerated, lambda e: heard.set())
    rig.say("tell me a story")
    model.allowed.release(3)
    assert heard.wait(60)
    rig.conversation.submit(Interrupt())
    rig.settle()
    assert all(e.cut for e in rig.of(Responded))
    assert rig.states()[-2:] == ["interrupted", "listening"]
    rig.say("where are you")
    rig.settle()
    assert rig.texts()[-1] == "I am at 1.2."
    assert not rig.of(Responded)[-1].cut


def test_what_waited_before_a_stop_is_forgotten(open_rig):
    model = StoryTeller()
    rig = open_rig(model=model)
    rig.say("tell me a story")
    assert model.begun.wait(60)
    rig.say("go to the kitchen")
    rig.say("stop")
    rig.settle()
    assert rig.body.sent == []


def test_a_stop_with_nothing_to_stop_is_answered(rig):
    rig.say("stop")
    rig.settle()
    assert rig.texts() == [phrases.said("standing")]
    assert "interrupted" not in rig.states()


def test_ten_interrupts_in_a_row_change_nothing_when_idle(rig):
    for _ in range(10):
        rig.conversation.submit(Interrupt())
    rig.settle()
    assert rig.states() == ["listening"]
    rig.say("where are you")
    rig.settle()
    assert rig.texts() == ["I am at 1.2."]


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("", phrases.said("not_heard")),
        (" \x00\ufffd\n ", phrases.said("not_heard")),
        ("a" * 100_000, phrases.said("too_long", length=100_000, limit=2000)),
        ("go to the garage", UNKNOWN_ROOM),
        ("go to", phrases.said("missing_word", argument="room", known=ROOMS_SAID)),
    ],
)
def test_bad_input_has_its_clear_answer(rig, text, answer):
    rig.say(text)
    rig.settle()
    assert rig.texts() == [answer]


def test_without_a_model_an_unknown_sentence_is_answered_with_what_the_robot_can_do(rig):
    rig.say("sing a song")
    rig.settle()
    assert rig.texts() == [phrases.said("not_understood_but", action="open the door")]


def test_reset_stops_the_robot_and_forgets(rig):
    rig.say("go to the kitchen")
    rig.body.starts()
    rig.conversation.submit(Reset())
    assert not rig.body.moving
    rig.settle()
    assert [m.role for m in rig.conversation.interpreter.chat()][-1:] != ["user"]


def test_a_skill_can_be_run_without_language(rig):
    rig.conversation.submit(RunSkill("navigate_to", {"room": "moon"}))
    rig.settle()
    assert rig.texts() == [phrases.refused("not_one_of", value="moon", choices=ROOMS)]


def test_speak_says_the_text_as_it_is(rig):
    rig.conversation.submit(Speak("The shop closes in ten minutes."))
    rig.settle()
    assert rig.texts() == ["The shop closes in ten minutes."]


@pytest.mark.parametrize("characters", [2001, 1_000_000, 5_000_000])
@pytest.mark.parametrize("command", [Speak, TextInput])
def test_what_is_too_long_is_refused_for_that_and_the_person_is_told(rig, command, characters):
    rig.conversation.submit(command("x" * characters))
    rig.settle()
    told = phrases.said("too_long", length=characters, limit=2000)
    assert rig.texts() == [told]
    assert rig.conversation.refusals == {"too_many": 0, "too_long": 1}


def test_what_is_just_not_too_long_is_said_whole(rig):
    rig.conversation.submit(Speak("x" * 2000))
    rig.settle()
    assert rig.texts() == ["x" * 2000]
    assert rig.conversation.refusals == {"too_many": 0, "too_long": 0}


def test_each_reason_of_a_refusal_is_on_the_log_a_few_times_only(open_rig):
    model = StoryTeller()
    with logging_to_memory() as logged:
        rig = open_rig(model=model)
        for _ in range(20):
            rig.conversation.submit(Speak("x" * 1_000_000))
        rig.settle()
        rig.say("tell me a story")
        assert model.begun.wait(60)
        for _ in range(1000):
            rig.say("where are you")
        rig.conversation.submit(Interrupt())
        rig.settle()
    refused = [(one["reason"], one["limit"]) for one in logged.of("request_refused")]
    assert refused == [("too_long", 2000)] * MOST_LINES + [("too_many", MAX_WAITING)] * MOST_LINES


def test_a_plain_command_of_another_agent_is_handed_over(open_rig):
    body_skills = FakeBody().skills(*SKILLS)
    talker = Agent("talker", "Talk.", SkillSet(()), handoffs=("driver",))
    rig = open_rig(agents=[talker, Agent("driver", "Drive.", body_skills)])
    rig.say("where are you")
    rig.settle()
    assert ("handoff", None) in rig.agent_events()
    assert rig.conversation.interpreter.active.name == "driver"
    rig.conversation.submit(Reset())
    rig.settle()
    assert rig.conversation.interpreter.active.name == "talker"


def test_a_turn_is_measured(rig):
    rig.say("where are you")
    rig.settle()
    (measured,) = rig.of(TurnMeasured)
    assert 0 < measured.ttfs <= measured.total


def test_a_flood_is_bounded_and_the_next_command_works(open_rig):
    model = StoryTeller()
    rig = open_rig(model=model)
    rig.say("tell me a story")
    assert model.begun.wait(60)
    for _ in range(1000):
        rig.say("where are you")
    assert rig.conversation.refusals == {"too_many": 1000 - MAX_WAITING, "too_long": 0}
    rig.conversation.submit(Interrupt())
    rig.settle()
    rig.say("where are you")
    rig.settle()
    assert rig.texts()[-1] == "I am at 1.2."
