"""The head that says how sure a reading is, and what nobody asked for never moves."""

import numpy as np
import pytest
from corpus_robots import skills_of_robots
from support.conversation import ORDER, TALK, CertainEncoder, Eloquent

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.head import read_head
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.meaning import ASK_FROM, HEARD_FROM, SURE_FROM, Meaning
from edgevox.agent.skills import Call
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock

APARTMENT = skills_of_robots()["robot-apartment"]
EAGER = Eloquent('call: navigate_to(room="kitchen"); done')
"""A model that would call a skill, whatever it was asked."""
WISH = "I'd be so glad to see you in the kitchen"


def decider(logit: float) -> Decider:
    return Decider(CertainEncoder(logit), read_head())


def interpreter(model: Eloquent | None = None, judge: Decider | None = None) -> Interpreter:
    return Interpreter([Agent("robot", "", APARTMENT)], Bus(), SystemClock(), model, decider=judge)


def turn() -> Turn:
    return Turn(1, Bus(), SystemClock(), on_speech=lambda: None)


def test_the_head_weighs_what_the_evidence_names() -> None:
    judged = Readings(APARTMENT, "en").of(WISH)

    assert judged is not None
    assert set(read_head().names) == judged.evidence.keys()


def test_confidence_rises_with_likelihood_and_has_its_borders_where_the_head_says() -> None:
    head = read_head()
    levels = [head.confidence(one) for one in np.linspace(0, 1, 101)]

    assert levels == sorted(levels)
    assert head.confidence(head.ask) == pytest.approx(ASK_FROM)
    assert head.confidence(head.sure) == pytest.approx(SURE_FROM)
    assert (levels[0], levels[-1]) == (0.0, 1.0)


def test_the_same_words_are_done_as_an_order_and_left_as_talk() -> None:
    readings = Readings(APARTMENT, "en")
    ordered = decider(ORDER).decide(readings.of(WISH), WISH)

    assert ordered is not None
    assert ordered.calls == (Call("navigate_to", {"room": "kitchen"}),)
    assert decider(TALK).decide(readings.of(WISH), WISH) is None


def test_a_motion_beside_a_strange_word_is_never_sure() -> None:
    text = "open the window"
    readings = Readings(skills_of_robots()["robot-panda"], "en")
    decision = decider(ORDER).decide(readings.of(text), text)

    assert decision is None or not decision.sure


@pytest.mark.parametrize(
    "text",
    [
        "turn the lamp on in the kitchen",
        "bring the tray to the kitchen",
        "bring it to the kitchen",
        "Lucy, drive to the kitchen",
        "I want to go to the kitchen",
        "off to the kitchen then, see you all",
        "nice kitchen",
    ],
)
def test_a_thing_another_person_or_a_plan_beside_a_place_is_never_sure(text: str) -> None:
    decision = decider(ORDER).decide(Readings(APARTMENT, "en").of(text), text)

    assert decision is None or not decision.sure


def test_a_remark_about_a_place_is_asked_about_however_sure_the_head_is() -> None:
    text = "la cuisine est l\u00e0"
    decision = decider(ORDER).decide(Readings(APARTMENT, "fr").of(text), text)

    assert decision is not None
    assert not decision.sure


def test_what_is_held_back_is_not_done_however_sure_the_head_is() -> None:
    text = "do not drive to the kitchen, robot"

    assert decider(ORDER).decide(Readings(APARTMENT, "en").of(text), text) is None


def test_without_a_judge_only_templates_move() -> None:
    assert interpreter().understand(WISH, turn()) is None
    meaning = interpreter().understand("go to the kitchen", turn())

    assert meaning is not None
    assert meaning.confidence == 1.0


@pytest.mark.parametrize("judge", [None, decider(ORDER), decider(TALK)])
def test_a_model_that_calls_what_nobody_said_moves_nothing(judge: Decider | None) -> None:
    assert interpreter(EAGER, judge).understand("why does ice float", turn()) is None


def test_a_room_that_is_not_there_is_refused_by_name() -> None:
    answer = turn()

    assert interpreter(EAGER, decider(ORDER)).understand("go to the garage", answer) is None
    assert "garage" in answer.text


def test_an_order_that_is_read_says_who_found_it_and_how_sure() -> None:
    meaning = interpreter(judge=decider(ORDER)).understand(WISH, turn())

    assert meaning is not None
    assert (meaning.source, meaning.confidence >= ASK_FROM) == ("reading", True)


@pytest.mark.parametrize(
    ("read", "heard", "sure"),
    [
        (1.0, HEARD_FROM, True),
        (1.0, HEARD_FROM - 0.01, False),
        (0.88, 0.95, True),
        (0.88, 0.9, False),
        (SURE_FROM, 1.0, True),
        (SURE_FROM, 0.98, False),
    ],
)
def test_words_must_be_surer_where_their_meaning_is_less_sure(read, heard, sure):
    agent = Agent("robot", "", APARTMENT)
    meaning = Meaning(agent, (Call("navigate_to", {"room": "kitchen"}),), "reading", read)
    assert meaning.heard(heard).sure is sure
