"""Its own question is answered without the wake word, by the person whom it asked: real voices."""

import numpy as np
import pytest
from listener_rig import loud, says_piper, silence

from edgevox.core.agent_events import Confirmation, ConfirmationStatus, GoalChanged
from edgevox.core.events import Responded, Transcribed, TurnEnded

NEAR, FAR = 0.08, 0.02
"""How loud a person is who speaks to the robot, and one in the next room."""


@pytest.fixture(scope="module")
def home_with():
    return {"wakeword": "hey jarvis", "confirm": "always"}


def hears(rig, text, level=NEAR):
    sound = loud(says_piper(text), level)
    rig.room.play(np.concatenate([silence(0.5), sound, silence(2.0)]))
    assert rig.parts.listener.transcriber.wait_idle(60)


def asked(rig):
    """A spoken order, which it asks about."""
    hears(rig, "hey jarvis, go to the kitchen")
    rig.wait_for(Confirmation, lambda one: one.status is ConfirmationStatus.ASKED)
    rig.wait_for(TurnEnded)


def test_a_yes_without_the_wake_word_is_done(rig):
    asked(rig)

    hears(rig, "yes, please.")

    rig.wait_for(Confirmation, lambda one: one.status is ConfirmationStatus.CONFIRMED)
    rig.wait_for(GoalChanged)
    assert rig.calls() == [("navigate_to", {"room": "kitchen"})]


def test_another_room_is_what_is_asked_then(rig):
    asked(rig)

    hears(rig, "no, the office.")

    rig.wait_until(lambda: len(rig.of(Responded)) == 2)
    assert "office" in rig.of(Responded)[1].text
    assert rig.calls() == []


@pytest.mark.parametrize(
    ("text", "level"),
    [("yes, please.", FAR), ("The weather was lovely this morning.", NEAR)],
    ids=["from the next room", "talk"],
)
def test_what_is_not_its_answer_leaves_the_question_open_and_it_says_nothing(rig, text, level):
    asked(rig)
    heard = len(rig.of(Transcribed))

    hears(rig, text, level)

    assert rig.parts.conversation.wait_idle(60)
    assert len(rig.of(Transcribed)) == heard
    assert [one.status for one in rig.of(Confirmation)] == [ConfirmationStatus.ASKED]
    assert rig.calls() == []
