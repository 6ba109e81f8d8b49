"""When somebody who fell silent has ended, by the words of what was said."""

import pytest
from corpus_robots import skills_of_robots

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.hearing.endings import Endings
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES
from edgevox.core.speech import Ending

ROBOTS = skills_of_robots()
JUDGED = [code for code in LANGUAGES if phrasebook(code).hearing.goes_on]


def endings(robot, language="en"):
    interpreter = Interpreter(
        [Agent("robot", "", ROBOTS[robot])], Bus(), SystemClock(), language=language
    )
    return Endings(
        interpreter.plain,
        is_stop=lambda text: find_stop_word(language, text) is not None,
        hearing=lambda: interpreter.phrases.hearing,
    )


@pytest.fixture(scope="module")
def apartment():
    return endings("robot-apartment")


@pytest.fixture(scope="module")
def humanoid():
    return endings("robot-humanoid")


@pytest.mark.parametrize(
    "text", ["Go to the kitchen.", "please drive to the bedroom", "Where are you?"]
)
def test_a_plain_command_is_whole(apartment, text):
    assert apartment.of(text) is Ending.WHOLE


def test_a_stop_is_final_whatever_follows(apartment):
    assert apartment.of("Stop!") is Ending.FINAL


@pytest.mark.parametrize(
    "text", ["Go to the", "go to", "Go to the kitchen, and", "could you", "Um...", "drive to my"]
)
def test_what_ends_in_a_word_that_more_must_follow_breaks_off(apartment, text):
    assert apartment.of(text) is Ending.BROKEN_OFF


@pytest.mark.parametrize("text", ["turn left", "Turn right."])
def test_a_command_that_a_longer_template_continues_may_go_on(humanoid, text):
    assert humanoid.of(text) is Ending.MAY_GO_ON


def test_the_longer_one_is_whole(humanoid):
    assert humanoid.of("turn left 90 degrees") is Ending.WHOLE


@pytest.mark.parametrize(
    "text",
    [
        "",
        "tell me about the moon",
        "go to the kitchin garden",
        "go to the kitchen and then to the bedroom",
        "remember this place as the charger",
        "yes",
    ],
)
def test_anything_else_is_open(apartment, text):
    assert apartment.of(text) is Ending.OPEN


@pytest.mark.parametrize(
    ("language", "whole", "broken"),
    [
        ("de", "fahr in die Küche", "fahr in die"),
        ("fr", "va dans la cuisine", "va dans la"),
        ("es", "ve a la cocina", "ve a la"),
        ("it", "vai in cucina", "vai nella"),
        ("nl", "ga naar de keuken", "ga naar de"),
    ],
)
def test_languages_that_list_their_words_are_judged_alike(language, whole, broken):
    judged = endings("robot-apartment", language)

    assert judged.of(whole) is Ending.WHOLE
    assert judged.of(broken) is Ending.BROKEN_OFF


def test_a_language_without_these_words_waits_as_for_anything():
    assert endings("robot-apartment", "pl").of("jedź do kuchni") is Ending.OPEN


@pytest.mark.parametrize("code", JUDGED)
def test_no_plain_command_ends_in_a_word_that_more_must_follow(code):
    judged = endings("robot-apartment", code)
    written = phrasebook(code).hearing.written

    cut = [one for one in written.split(".") if judged.of(one) is Ending.BROKEN_OFF and one.strip()]

    assert cut == []
