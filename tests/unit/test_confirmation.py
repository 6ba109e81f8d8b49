"""Between sure and refused lies a question, and a yes or a no is its answer."""

import threading

import phrases
import pytest
from confirmation_rig import Doubts, Eloquent, Talk

from edgevox.agent.confirmation import EXPIRES_S
from edgevox.agent.nlu.confidence import SURE_FROM
from edgevox.agent.policy import Guard
from edgevox.core.agent_events import AskedCall, Confirmation, ToolCalled
from edgevox.core.commands import RunSkill, TextInput
from edgevox.core.events import Outcome


def test_what_is_asked_first_is_told_with_its_calls_and_done_when_confirmed():
    with Talk() as talk:
        talk.say("go to the kitchen")
        assert talk.answers == [phrases.asks("navigate_to", room="kitchen")]
        assert talk.outcomes == [Outcome.ASKED]
        assert talk.body.sent == []
        (asked,) = talk.questions
        assert asked.question == phrases.asks("navigate_to", room="kitchen")
        assert asked.calls == (AskedCall("navigate_to", {"room": "kitchen"}),)
        assert (asked.expires_s, asked.turn) == (EXPIRES_S, 1)

        talk.say("yes, please")
        assert talk.body.sent == ["kitchen"]
        assert talk.answers[1:] == ["Going to the kitchen.", "I am in the kitchen."]
        assert talk.statuses == ["asked", "confirmed"]
        assert {one.turn for one in talk.questions} == {1}


def test_a_model_is_not_shown_a_question_since_it_would_ask_the_like_and_mean_nothing():
    with Talk(model=Eloquent()) as talk:
        talk.say("go to the kitchen", "yes", "where are you")
        told = [message.content for message in talk.conversation.interpreter.chat()]
        assert talk.answers[0] == phrases.asks("navigate_to", room="kitchen")
        assert not any("Shall I" in said for said in told)
        assert any("get_pose" in said for said in told)


def test_a_no_leaves_it():
    with Talk() as talk:
        talk.say("go to the kitchen", "better not", "yes")
        assert talk.answers[1:] == [phrases.said("left_undone"), phrases.said("nothing_asked")]
        assert talk.statuses == ["asked", "declined"]
        assert talk.body.sent == []


def test_several_calls_are_one_question_and_all_of_them_are_done():
    with Talk() as talk:
        both = ["go to the kitchen", "walk 2 metres forward"]
        talk.say("go to the kitchen, then where are you, then walk 2 meters")
        assert talk.answers == [
            phrases.said("shall_i", actions=phrases.said("and_then").join(both))
        ]
        assert [one.skill for one in talk.questions[0].calls] == [
            "navigate_to",
            "get_pose",
            "walk_forward",
        ]
        talk.say("do it")
        assert talk.body.sent == ["kitchen", 2.0]


def test_a_skill_without_words_for_a_question_is_asked_about_in_those_that_it_has():
    with Talk() as talk:
        talk.say("do your dance")
        assert talk.answers == [phrases.said("do_this", told="Dancing.")]


@pytest.mark.parametrize("sentence", ["where are you", "stay there"])
def test_what_does_not_drive_and_the_skill_that_stops_are_never_asked_about(sentence):
    with Talk() as talk:
        talk.say(sentence)
        assert talk.questions == []


def test_a_command_of_a_program_is_not_asked_about():
    with Talk() as talk:
        talk.conversation.submit(RunSkill("navigate_to", {"room": "office"}))
        assert talk.conversation.wait_idle(60)
        goal = talk.conversation.start_goal("walk_forward", {"distance": 3.0})
        assert goal.wait(60)
        assert talk.questions == []
        assert talk.body.sent == ["office", 3.0]


def test_what_can_never_be_done_is_refused_and_not_asked_about():
    with Talk() as talk:
        talk.say("walk 12 meters")
        assert talk.answers == [phrases.said("failed", reason="that is too far")]
        assert talk.questions == []


@pytest.mark.parametrize(
    ("confirm", "confidence", "asks", "does"),
    [
        ("always", 1.0, True, False),
        ("always", 0.6, True, False),
        ("unsure", 1.0, False, True),
        ("unsure", SURE_FROM, False, True),
        ("unsure", SURE_FROM - 0.01, True, False),
        ("never", 1.0, False, True),
        ("never", SURE_FROM - 0.01, False, False),
    ],
)
def test_whether_it_asks_follows_from_the_setting_and_how_sure_it_is(
    confirm, confidence, asks, does
):
    with Doubts(confirm, confidence) as doubts:
        turn = doubts.say("go to the kitchen")
        assert bool(doubts.questions) is asks
        assert bool(doubts.body.sent) is does
        if not asks and not does:
            assert turn.text == phrases.said("say_plainly")
            assert turn.outcome is Outcome.REFUSED


def test_unsure_is_no_reason_to_ask_before_it_tells_something():
    with Doubts("unsure", 0.6) as doubts:
        assert doubts.say("where are you").text == "I am at 1.2."
        assert doubts.questions == []


@pytest.mark.parametrize("confirm", ["unsure", "never"])
@pytest.mark.parametrize(
    ("sentence", "question", "sent"),
    [
        ("go to the kitchen", phrases.asks("navigate_to", room="kitchen"), ["kitchen"]),
        ("where are you", phrases.said("do_this", told="Say where it is."), []),
    ],
)
def test_what_the_policy_wants_a_yes_for_is_asked_about_whatever_the_setting(
    confirm, sentence, question, sent, tmp_path
):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {text_input: confirm}")
    with Doubts(confirm, 1.0, Guard(file)) as doubts:
        assert doubts.say(sentence).text == question
        assert doubts.body.sent == []
        doubts.say("yes")
        assert doubts.body.sent == sent
        assert doubts.statuses == ["asked", "confirmed"]


def test_what_the_policy_denies_is_refused_and_not_asked_about(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {text_input: {navigate_to: deny}}")
    with Doubts("always", 1.0, Guard(file)) as doubts:
        assert doubts.say("go to the kitchen").outcome is Outcome.REFUSED
        assert doubts.questions == []


def test_the_setting_counts_from_the_next_sentence_on():
    with Talk("unsure") as talk:
        talk.say("go to the kitchen")
        talk.conversation.set_confirm("always")
        talk.say("go to the office")
        talk.conversation.set_confirm("never")
        talk.say("go to the bedroom")
        assert talk.body.sent == ["kitchen", "bedroom"]
        assert talk.statuses == ["asked", "replaced"]


def test_a_yes_without_a_question_is_answered_and_does_nothing():
    with Talk("unsure") as talk:
        talk.say("yes", "no")
        assert talk.answers == [
            phrases.said("nothing_asked"),
            phrases.said("what_instead"),
        ]
        assert talk.body.sent == []


def test_words_that_are_a_command_without_a_question_are_one_answer_with_it():
    with Talk("unsure") as talk:
        talk.say("go ahead")
        talk.conversation.set_confirm("always")
        talk.say("go to the kitchen", "go ahead")
        assert talk.body.sent == [1.0, "kitchen"]


def test_a_yes_from_before_the_question_is_no_answer_to_it():
    """As where somebody says yes to somebody else while the robot still thinks."""
    with Doubts() as doubts:
        doubts.say("go to the kitchen")
        turn = doubts.new_turn()
        doubts.asking.attend("yes", turn, doubts.clock.now() - 0.1)
        assert doubts.body.sent == []
        doubts.say("yes")
        assert doubts.body.sent == ["kitchen"]


def test_being_asked_while_it_drives_does_not_stop_the_drive():
    with Talk("unsure") as talk:
        talk.body.drive_on()
        talk.conversation.submit(TextInput("go to the kitchen"))
        talk.body.starts()
        talk.conversation.set_confirm("always")
        asked = threading.Event()
        talk.bus.subscribe(Confirmation, lambda _: asked.set())
        talk.conversation.submit(TextInput("go to the office"))
        assert asked.wait(60)
        assert talk.body.moving
        talk.body.arrive()
        assert talk.conversation.wait_idle(60)
        talk.say("sure")
        assert talk.body.sent == ["kitchen", "office"]


def test_who_called_is_told_as_it_was_understood():
    with Talk() as talk:
        called = []
        talk.bus.subscribe(ToolCalled, called.append)
        talk.say("go to the kitchen", "yes")
        assert [(one.source, one.turn) for one in called] == [("template", 2)]
