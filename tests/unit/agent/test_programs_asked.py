"""Programs are asked about and permitted as what they hold is: when they are told and when done."""

from contextlib import ExitStack

import phrases
import pytest
from support.conversation import drives

from edgevox.agent.programs.keeper import LEAD_S
from edgevox.core.commands import Way

LATER = "in five minutes, go to the office"
KEPT = phrases.said(
    "program_after", duration=phrases.said("minutes", count=5), order="going to the office."
)
PATROL = "patrol between the kitchen and the office"
QUESTION = phrases.said("do_this", told=KEPT)
DENIED = phrases.refused("policy_denied")
REMARKS = [
    "I patrol between the kitchen and the office every night",
    "she said in five minutes go to the office",
    "my phone says in five minutes go to the office",
    "don't go to the office in five minutes",
    "in five minutes, never go to the office",
    "in five minutes I go to the office",
    "if the battery were low you'd go to the dock",
    "if the battery is not below twenty percent, go to the dock",
    "would you go to the dock if the battery is below twenty percent?",
    "do you patrol between the kitchen and the office?",
    "did you go to the kitchen three times",
    "do not go to the kitchen and back three times",
    "go to the office not in five minutes but now",
    "go to the office in five minutes three times a day",
    "go to the office every five minutes",
    "until I say stop you are my friend",
    "imagine that in five minutes you go to the office",
]


@pytest.fixture
def always():
    with drives(confirm="always") as one:
        yield one


@pytest.fixture
def ruled(tmp_path):
    """Makes a conversation under a policy, which can be written anew."""
    file = tmp_path / "policy.yaml"
    with ExitStack() as opened:

        def write(text):
            file.write_text(text)
            return opened.enter_context(drives(policy=file))

        yield write


def test_a_program_is_asked_about_in_words_and_kept_after_a_yes(always):
    assert always.ask(LATER) == QUESTION
    assert not always.conversation.programs.kept
    assert always.told("confirmation")[0]["calls"] == [
        {"skill": "navigate_to", "arguments": {"room": "office"}}
    ]
    assert always.ask("yes") == "In 5 minutes: going to the office."
    always.clock.advance(300 + LEAD_S)
    always.body.arrive(1)
    always.until_said("I am in the office.")


@pytest.mark.parametrize("answer", ["no", "stop", "sing a song"])
def test_a_program_that_nobody_said_yes_to_never_moves(always, answer):
    always.ask(LATER)
    always.ask(answer)
    always.ask("yes")
    always.clock.advance(3600)
    assert not always.conversation.programs.kept
    assert not always.body.sent


def test_words_for_later_are_not_asked_about(always):
    assert always.ask("in two minutes, say dinner is ready").startswith("In 2 minutes")


def test_a_program_with_a_forbidden_step_is_refused_when_it_is_told(ruled):
    talk = ruled("rules: {'*': {navigate_to: deny}}")
    assert talk.ask(PATROL) == DENIED
    assert talk.ask(LATER) == DENIED
    assert not talk.conversation.programs.kept


def test_a_step_that_needs_a_yes_is_asked_about_once_and_done_when_it_is_due(ruled):
    talk = ruled("rules: {text_input: confirm}")
    assert talk.ask(LATER) == QUESTION
    talk.ask("yes")
    talk.body.arrive(1)
    talk.clock.advance(300 + LEAD_S)
    talk.until_said("I am in the office.")


def test_a_step_is_judged_again_when_it_is_due_by_the_way_of_who_gave_the_order(tmp_path, ruled):
    talk = ruled("rules: {}")
    talk.ask(LATER, Way.VOICE)
    (tmp_path / "policy.yaml").write_text("rules: {voice: {navigate_to: deny}}  # changed since")
    talk.clock.advance(300 + LEAD_S)
    talk.until(lambda: "failed" in talk.programs)
    assert not talk.body.sent
    assert talk.told("program")[-1]["code"] == "policy_denied"
    (refused,) = [event for event in talk.events if event.get("way")]
    assert refused["way"] == "voice"


def test_each_round_of_a_patrol_is_judged_again(tmp_path, ruled):
    talk = ruled("rules: {}")
    talk.ask(PATROL)
    talk.body.starts_until(1)
    (tmp_path / "policy.yaml").write_text("limits: {places: {never: [office]}}  # changed since")
    talk.body.arrive(1)
    talk.until(lambda: "failed" in talk.programs)
    assert talk.body.sent == ["kitchen"]


def test_an_order_for_later_is_no_drive_that_no_the_kitchen_corrects(always):
    always.conversation.set_confirm("unsure")
    always.ask(LATER)
    always.ask("no, the kitchen")
    assert not always.body.sent


def test_again_after_a_program_asks_to_say_all_of_it(always):
    always.conversation.set_confirm("unsure")
    always.ask(LATER)
    assert "Say all of it" in always.ask("again")
    assert not always.body.sent


def test_three_times_after_a_round_trip_is_about_the_round_trip(always):
    always.conversation.set_confirm("unsure")
    always.body.arrive(2)
    assert always.ask("go to the kitchen and come back") == (
        "Going to the kitchen. Then: going back."
    )
    always.until_said("I am there.")
    assert always.ask("do that three times") == ("3 times: going to the kitchen. Then: going back.")


@pytest.mark.parametrize("remark", REMARKS)
def test_a_remark_about_times_and_conditions_starts_nothing(remark):
    with drives() as talk:
        talk.ask(remark)
        assert not talk.conversation.programs.kept
        assert not talk.body.sent


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("de", "fahr in die K\u00fcche und sag mir wie es da aussieht"),
        ("fr", "va dans la cuisine et dis moi comment c'est"),
        ("nl", "ga naar de keuken en zeg me hoe het daar is"),
    ],
)
def test_what_somebody_wants_to_be_told_is_not_said_aloud(language, text):
    with drives(language=language) as talk:
        talk.ask(text)
        assert not talk.conversation.programs.kept
        assert not talk.body.sent
