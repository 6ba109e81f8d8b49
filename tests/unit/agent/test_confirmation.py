"""Between sure and refused lies a question, and a yes or a no is its answer."""

import phrases
import pytest
from support.conversation import Talk

from edgevox.agent.dialogue.question import EXPIRES_S
from edgevox.agent.nlu.meaning import SURE_FROM
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import AskedCall, ToolCalled
from edgevox.core.commands import RunSkill
from edgevox.core.events import Outcome


def test_what_is_asked_first_is_told_with_its_calls_and_done_when_confirmed():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        assert talk.said == ["Shall I go to the kitchen?"]
        assert talk.outcomes == [Outcome.ASKED]
        assert talk.body.sent == []
        (asked,) = talk.questions
        assert asked.question == phrases.asks("navigate_to", room="kitchen")
        assert asked.calls == (AskedCall("navigate_to", {"room": "kitchen"}),)
        assert (asked.expires_s, asked.turn) == (EXPIRES_S, 1)

        talk.say("yes, please")
        assert talk.body.sent == ["kitchen"]
        assert talk.said[1:] == ["Going to the kitchen.", "I am in the kitchen."]
        assert talk.statuses == ["asked", "confirmed"]
        assert {one.turn for one in talk.questions} == {1}


def test_a_no_leaves_it():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen", "better not", "yes")
        assert talk.said[1:] == ["All right, I leave it.", "Yes. What can I do for you?"]
        assert talk.statuses == ["asked", "declined"]
        assert talk.body.sent == []


def test_several_calls_are_one_question_and_all_of_them_are_done():
    with Talk(confirm="always") as talk:
        both = ["go to the kitchen", "walk 2 metres forward"]
        talk.say("go to the kitchen, then where are you, then walk 2 meters")
        assert talk.said == [phrases.said("shall_i", actions=phrases.said("and_then").join(both))]
        assert [one.skill for one in talk.questions[0].calls] == [
            "navigate_to",
            "get_pose",
            "walk_forward",
        ]
        talk.say("do it")
        assert talk.body.sent == ["kitchen", 2.0]


def test_a_skill_without_words_for_a_question_is_asked_about_in_those_that_it_has():
    with Talk(confirm="always") as talk:
        talk.say("do your dance")
        assert talk.said == ["Shall I do this? Dancing."]


@pytest.mark.parametrize("sentence", ["where are you", "stay there"])
def test_what_does_not_drive_and_the_skill_that_stops_are_never_asked_about(sentence):
    with Talk(confirm="always") as talk:
        talk.say(sentence)
        assert talk.questions == []


def test_a_command_of_a_program_is_not_asked_about():
    with Talk(confirm="always") as talk:
        talk.conversation.submit(RunSkill("navigate_to", {"room": "office"}))
        talk.settle()
        goal = talk.conversation.start_goal("walk_forward", {"distance": 3.0})
        assert goal.wait(60)
        assert talk.questions == []
        assert talk.body.sent == ["office", 3.0]


def test_what_can_never_be_done_is_refused_and_not_asked_about():
    with Talk(confirm="always") as talk:
        talk.say("walk 12 meters")
        assert talk.said == [phrasebook("en").failure(because("too_far"))]
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
    with Talk(confirm=confirm) as talk:
        talk.doubt(confidence).say("go to the kitchen")
        assert bool(talk.questions) is asks
        assert bool(talk.body.sent) is does
        if not asks and not does:
            assert talk.said == [phrasebook("en").say("say_plainly")]
            assert talk.outcomes == [Outcome.REFUSED]


def test_unsure_is_no_reason_to_ask_before_it_tells_something():
    with Talk() as talk:
        assert talk.doubt(0.6).say("where are you") == "I am at 1.2."
        assert talk.questions == []


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
    with Talk(confirm=confirm, policy=file) as talk:
        assert talk.say(sentence) == question
        assert talk.body.sent == []
        talk.say("yes")
        assert talk.body.sent == sent
        assert talk.statuses == ["asked", "confirmed"]


def test_what_the_policy_denies_is_refused_and_not_asked_about(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {text_input: {navigate_to: deny}}")
    with Talk(confirm="always", policy=file) as talk:
        talk.say("go to the kitchen")
        assert talk.outcomes == [Outcome.REFUSED]
        assert talk.questions == []


def test_the_setting_counts_from_the_next_sentence_on():
    with Talk() as talk:
        talk.say("go to the kitchen")
        talk.conversation.set_confirm("always")
        talk.say("go to the office")
        talk.conversation.set_confirm("never")
        talk.say("go to the bedroom")
        assert talk.body.sent == ["kitchen", "bedroom"]
        assert talk.statuses == ["asked", "replaced"]


def test_a_yes_without_a_question_is_answered_and_does_nothing():
    with Talk() as talk:
        talk.say("yes", "no")
        assert talk.said == [
            phrases.said("nothing_asked"),
            phrases.said("what_instead"),
        ]
        assert talk.body.sent == []


def test_words_that_are_a_command_without_a_question_are_one_answer_with_it():
    with Talk() as talk:
        talk.say("go ahead")
        talk.conversation.set_confirm("always")
        talk.say("go to the kitchen", "go ahead")
        assert talk.body.sent == [1.0, "kitchen"]


def test_a_yes_from_before_the_question_is_no_answer_to_it():
    """As where somebody says yes to somebody else while the robot still thinks."""
    with Talk() as talk:
        talk.doubt(0.6).say("go to the kitchen")
        talk.hear("yes", talk.clock.now() - 0.1)
        assert talk.body.sent == []
        talk.say("yes")
        assert talk.body.sent == ["kitchen"]


def test_being_asked_while_it_drives_does_not_stop_the_drive():
    with Talk() as talk:
        talk.begin("go to the kitchen")
        talk.conversation.set_confirm("always")
        talk.ask("go to the office")
        assert talk.body.moving
        talk.body.arrive()
        talk.settle()
        talk.say("sure")
        assert talk.body.sent == ["kitchen", "office"]


def test_who_called_is_told_as_it_was_understood():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen", "yes")
        assert [(one.source, one.turn) for one in talk.of(ToolCalled)] == [("template", 2)]
