"""A countdown: the robot says what it will do, and does it a second later unless it hears no."""

from contextlib import contextmanager

import pytest
from support.bodies import BODIES
from support.body import FakeBody
from support.conversation import Talk

from edgevox.agent.dialogue.question import COUNTDOWN_S, EXPIRES_S, SPOKEN_S
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM
from edgevox.agent.skills import Call
from edgevox.core.agent_events import GoalRejected, ToolCalled
from edgevox.core.commands import Heard, Interrupt, RunSkill, StopSpotted, TextInput
from edgevox.core.events import TurnEnded
from edgevox.core.languages import LANGUAGES

KITCHEN, OFFICE = Call("navigate_to", {"room": "kitchen"}), Call("navigate_to", {"room": "office"})
RULES = '{navigate_to: countdown, walk_forward: countdown, grasp: countdown, "*": allow}'


@contextmanager
def counting(tmp_path, rules=RULES, **more):
    """A robot whose policy counts down, and that has just said that it will go to the kitchen."""
    policy = tmp_path / "policy.yaml"
    policy.write_text(f"rules: {{voice: {rules}, text_input: {rules}}}\n")
    skills = ("navigate_to", "walk_forward", "grasp", "get_pose", "stop")
    with Talk(skills=skills, policy=policy, **more) as talk:
        yield talk


def passes(talk, seconds=COUNTDOWN_S):
    """Let time pass, and wait for what comes of it: any turn's end wakes the conversation."""
    before = len(talk.of(TurnEnded))
    talk.clock.now_s += seconds
    talk.until(lambda: len(talk.of(TurnEnded)) > before)
    talk.settle()


def test_it_says_what_it_will_do_and_does_it_a_second_later(tmp_path):
    with counting(tmp_path) as talk:
        assert talk.say("go to the kitchen") == "I will go to the kitchen."
        asked = talk.questions[-1]
        assert (asked.status, asked.goes, asked.expires_s) == ("asked", True, COUNTDOWN_S)
        assert talk.body.sent == []
        passes(talk)
        assert talk.body.sent == ["kitchen"]
        assert talk.statuses == ["asked", "counted_down"]


@pytest.mark.parametrize(
    "said", ["no", "not the kitchen", "never mind", "sing a song", "where are you"]
)
def test_whatever_is_no_agreement_ends_it(tmp_path, said):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen", said)
        talk.clock.now_s += EXPIRES_S
        assert talk.say("where are you")
        assert talk.body.sent == []
        assert talk.statuses[-1] in ("declined", "replaced")


@pytest.mark.parametrize("said", ["yes", "mm-hm", "go ahead"])
def test_agreement_does_it_at_once(tmp_path, said):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen", said)
        assert talk.body.sent == ["kitchen"]
        assert talk.statuses == ["asked", "confirmed"]


def test_a_new_order_replaces_it(tmp_path):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen", "go to the office")
        assert talk.statuses == ["asked", "replaced", "asked"]
        passes(talk)
        assert talk.body.sent == ["office"]


def test_a_correction_counts_down_to_the_right_place(tmp_path):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen", "no, the office")
        assert talk.said[-1] == "I will go to the office."
        passes(talk)
        assert talk.body.sent == ["office"]


@pytest.mark.parametrize(
    "stops", [TextInput("stop"), StopSpotted(1000.0, "stop"), Interrupt(), TextInput("halt, no")]
)
def test_a_stop_of_any_kind_ends_it(tmp_path, stops):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen")
        talk.conversation.submit(stops)
        talk.settle()
        talk.clock.now_s += EXPIRES_S
        talk.say("where are you")
        assert talk.body.sent == []
        assert talk.statuses == ["asked", "cancelled"]


@pytest.mark.parametrize("way", ["command", "action"])
def test_an_order_by_another_way_ends_it(tmp_path, way):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen")
        if way == "command":
            talk.conversation.submit(RunSkill(OFFICE.skill, OFFICE.arguments))
        else:
            talk.conversation.start_goal(OFFICE.skill, OFFICE.arguments)
        talk.settle()
        talk.clock.now_s += EXPIRES_S
        talk.say("where are you")
        assert talk.body.sent == ["office"]
        assert talk.statuses == ["asked", "replaced"]


def test_who_begins_to_speak_in_the_second_is_waited_for(tmp_path):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen")
        talk.clock.now_s += COUNTDOWN_S / 2
        talk.conversation.follow_ups.begins()
        talk.clock.now_s += COUNTDOWN_S * 2  # so long does "no, not there" take until it is words
        talk.hear("no")
        assert talk.body.sent == []
        assert talk.statuses == ["asked", "declined"]


def test_where_the_words_never_come_it_asks_instead(tmp_path):
    with counting(tmp_path) as talk:
        talk.say("go to the kitchen")
        talk.conversation.follow_ups.begins()
        passes(talk, SPOKEN_S)
        assert talk.said[-1] == "Shall I go to the kitchen?"
        assert talk.statuses == ["asked", "expired", "asked"]
        assert talk.body.sent == []
        talk.say("yes")
        assert talk.body.sent == ["kitchen"]


def test_a_yes_that_was_hardly_heard_asks_instead(tmp_path):
    with counting(tmp_path) as talk:
        talk.hear("go to the kitchen")
        talk.hear("yes", confidence=0.3)
        assert talk.said[-1] == "Shall I go to the kitchen?"
        assert not talk.questions[-1].goes
        assert talk.body.sent == []


def test_any_words_count_without_the_wake_word_while_it_counts(tmp_path):
    with counting(tmp_path, follow_up_s=0.0) as talk:
        talk.hear("go to the kitchen")
        now_s = talk.clock.now()
        follow_ups = talk.conversation.follow_ups
        assert follow_ups.awaits(now_s, now_s)
        assert follow_ups.takes(Heard("no no not that", now_s, confidence=0.9))
        talk.say("no")
        assert not follow_ups.awaits(now_s, now_s)


@pytest.mark.parametrize(
    ("source", "confidence", "said", "goes"),
    [
        ("reading", SURE_FROM - 0.05, "off to the kitchen with you", True),
        ("reading", ASK_FROM, "off to the kitchen with you", False),
        ("reading", SURE_FROM, "off to the kitchen with you 5", False),
        ("reading", SURE_FROM, "not off to the kitchen with you", False),
    ],
)
def test_what_is_not_fairly_sure_is_asked_about(tmp_path, source, confidence, said, goes):
    with counting(tmp_path) as talk:
        talk.mean(KITCHEN, source=source, confidence=confidence).say(said)
        assert [one.goes for one in talk.questions] == [goes]


@pytest.mark.parametrize("said", ["take the red cube", "go to the kitchen then take the red cube"])
def test_what_cannot_be_undone_is_asked_about(tmp_path, said):
    with counting(tmp_path) as talk:
        talk.say(said)
        assert [one.goes for one in talk.questions] == [False]


@pytest.mark.parametrize("said", ["forget the place kitchen", "remember this place as the lab"])
def test_what_changes_something_for_good_is_asked_about(tmp_path, said):
    policy, body = tmp_path / "policy.yaml", FakeBody(arrives=True)
    policy.write_text('rules: {"*": countdown}\n')
    with Talk(body, skills=body.playing(BODIES["apartment"].values()), policy=policy) as talk:
        talk.say(said)
        assert [one.goes for one in talk.questions] == [False]


def test_what_only_tells_something_is_done_at_once(tmp_path):
    with counting(tmp_path, '{"*": countdown}') as talk:
        assert talk.say("where are you") == "I am at 1.2."
        assert talk.say("what are you doing") == "I am doing nothing right now."
        assert talk.questions == []


def test_it_asks_where_the_setting_wants_a_question_always(tmp_path):
    with counting(tmp_path, confirm="always") as talk:
        talk.say("go to the kitchen")
        assert [one.goes for one in talk.questions] == [False]


def test_a_stricter_rule_for_one_of_two_orders_asks(tmp_path):
    with counting(tmp_path, "{navigate_to: countdown, walk_forward: confirm}") as talk:
        talk.say("go to the kitchen then walk 2 metres")
        assert [one.goes for one in talk.questions] == [False]


def test_by_a_way_that_nobody_can_answer_it_is_refused(tmp_path):
    policy = tmp_path / "policy.yaml"
    policy.write_text('rules: {"*": {navigate_to: countdown}}\n')
    with Talk(policy=policy) as talk:
        talk.conversation.submit(RunSkill(KITCHEN.skill, KITCHEN.arguments))
        talk.settle()
        assert [one.reason.code for one in talk.of(GoalRejected)] == ["needs_a_person"]
        assert talk.of(ToolCalled) == []


def test_without_a_policy_nothing_counts_down(tmp_path):
    with Talk() as talk:
        talk.say("go to the kitchen")
        assert talk.questions == []
        assert talk.body.sent == ["kitchen"]


@pytest.mark.parametrize("code", LANGUAGES)
def test_each_language_says_it_and_names_the_place(tmp_path, code):
    with counting(tmp_path, language=code) as talk:
        book = talk.conversation.interpreter.phrases
        goal = (talk.skills["navigate_to"], KITCHEN.arguments)
        said, asked = book.announcement([goal]), book.question([goal])
        assert said not in (asked, "")
        assert "?" not in said
        assert any(one.casefold() in said.casefold() for one in book.word("kitchen").heard)
