"""What Whisper once made of commands in noise, and what the robot does about it."""

import pytest

from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.hearing.near import NearStop
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.turn import Turn
from edgevox.apps.agent.models import open_phonemes
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Way
from edgevox.robots.flat.apartment import ApartmentRobot


@pytest.fixture(scope="module")
def interpreter(decider: Decider) -> Interpreter:
    agents = build_agents(ApartmentRobot())
    bus, clock = Bus(), SystemClock()
    return Interpreter(agents, bus, clock, decider=decider, phonemes=open_phonemes())


def understood(interpreter: Interpreter, said: str, confidence: float) -> Meaning | None:
    turn = Turn(1, Bus(), SystemClock(), lambda: None, way=Way.VOICE, hearing=confidence)
    meaning = interpreter.understand(said, turn)
    return interpreter.as_heard(meaning, said, turn) if meaning else None


@pytest.mark.parametrize("confidence", [1.0, 0.7])
def test_what_is_nearly_a_command_is_asked_about(
    interpreter: Interpreter, confidence: float
) -> None:
    meaning = understood(interpreter, "Kitchen plate.", confidence)

    assert meaning is not None
    assert [(call.skill, call.arguments) for call in meaning.calls] == [
        ("navigate_to", {"room": "kitchen"})
    ]
    assert not meaning.sure


@pytest.mark.parametrize("said", ["This is the kitchen.", "Drive!", "Free is a..."])
def test_what_is_no_command_any_more_moves_nothing(interpreter: Interpreter, said: str) -> None:
    meaning = understood(interpreter, said, 0.7)

    called = [meaning.agent.skills[call.skill] for call in meaning.every_call] if meaning else []
    assert not any(skill.drives for skill in called)


def test_a_word_that_sounds_otherwise_is_not_swapped_for_another(interpreter: Interpreter) -> None:
    """As a whole it sounds much like "please bring me to the bedroom"."""
    meaning = understood(interpreter, "Please bring the mug to the bedroom.", 1.0)

    assert meaning is None or not meaning.sure


@pytest.mark.parametrize(("code", "heard"), [("en", "Free is a..."), ("ar", "توقع")])
def test_a_stop_word_that_is_nearly_heard_stops_a_robot_that_drives(code: str, heard: str) -> None:
    phonemes = open_phonemes()

    assert phonemes is not None
    assert SafetyWords(code).find(heard) is None
    assert NearStop(code, phonemes).find(heard) is not None
