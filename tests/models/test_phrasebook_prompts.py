"""What a model reads in each language, counted by the model of the small set."""

from functools import lru_cache

import pytest

from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES
from edgevox.robots.flat.apartment import ApartmentRobot

MOST_PROMPT_TOKENS = 1700
"""Two fifths of the context; scripts that the model's vocabulary is poor in take the most."""


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_prompt_leaves_room_for_the_conversation_in_every_language(tiny, code):
    tokens = sum(tiny.count_tokens(message.content) + 5 for message in opening(code))

    assert tokens <= MOST_PROMPT_TOKENS


@pytest.mark.parametrize("code", [code for code in LANGUAGES if code != "en"])
def test_the_prompt_names_the_language_to_answer_in(code):
    assert f"Every sentence that you say is {LANGUAGES[code].name}." in opening(code)[0].content


@lru_cache
def opening(code):
    """What the interpreter of the apartment's robot shows a model before anything is said."""
    return Interpreter(build_agents(ApartmentRobot()), Bus(), SystemClock(), language=code).chat()
