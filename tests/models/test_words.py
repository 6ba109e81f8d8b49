"""What the small language model is for, through the interpreter: words, and never a motion."""

from dataclasses import dataclass

import pytest

from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.nlu.model_answer import ANSWER_TOKENS
from edgevox.agent.turn import Turn
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.events import Outcome
from edgevox.robots.flat.apartment import ApartmentRobot

MOST_PROMPT_TOKENS = 800
SAID = (
    "make me a sandwich",
    "asdf qwer zxcv",
    "nice to meet you",
    "how old are you?",
    "turn on the lights",
    "I walked ten kilometres yesterday",
    "tell me a long story about a robot and a cat",
)
"""No template and no reading knows them; the smallest models once drove at some of these."""


@dataclass(frozen=True, slots=True)
class Answered:
    """What became of a sentence, and how many tokens its answer has."""

    meaning: Meaning | None
    outcome: Outcome | None
    words: str
    tokens: int


@pytest.fixture(scope="module")
def interpreter(small: LanguageModel, decider: Decider) -> Interpreter:
    agents = build_agents(ApartmentRobot())
    return Interpreter(agents, Bus(), SystemClock(), small, decider=decider)


@pytest.fixture(scope="module")
def answered(interpreter: Interpreter, small: LanguageModel) -> dict[str, Answered]:
    found = {}
    for said in SAID:
        turn = Turn(1, Bus(), SystemClock(), on_speech=lambda: None)
        meaning = interpreter.understand(said, turn)
        found[said] = Answered(meaning, turn.outcome, turn.text, small.count_tokens(turn.text))
    return found


@pytest.mark.parametrize("said", SAID)
def test_what_is_no_command_is_answered_in_words_and_moves_nothing(
    answered: dict[str, Answered], said: str
) -> None:
    assert answered[said].meaning is None
    assert answered[said].words


@pytest.mark.parametrize("said", SAID)
def test_an_answer_in_words_never_shows_a_call(answered: dict[str, Answered], said: str) -> None:
    assert not {"(", "call:", "talk:"} & set(answered[said].words.split())
    assert "(" not in answered[said].words


@pytest.mark.parametrize("said", SAID)
def test_an_answer_in_words_ends_at_a_sentence_or_at_the_limit(
    answered: dict[str, Answered], said: str
) -> None:
    one = answered[said]

    assert one.words[-1] in ".!?" or one.tokens >= ANSWER_TOKENS - 4


def test_the_prompt_stays_small_enough_to_be_primed_in_seconds(
    interpreter: Interpreter, small: LanguageModel
) -> None:
    tokens = sum(small.count_tokens(message.content) + 5 for message in interpreter.chat())

    assert tokens <= MOST_PROMPT_TOKENS
