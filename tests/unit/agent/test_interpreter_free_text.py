"""What a model may call: skills that take any words, asked for by an order that holds the words."""

from collections.abc import Iterator
from typing import Any

import pytest
from support.conversation import ORDER, TALK, CertainEncoder, Eloquent

from edgevox.agent.agents import Agent
from edgevox.agent.llm.gbnf import Matcher
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import read_head
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.skills import Call, GoalHandle, SkillSet, skill
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock

SAID = "jot down that the milk is empty"
NOTED = 'call: take_note(text="the milk is empty"); done'


@skill()
def take_note(goal: GoalHandle, text: str) -> None:
    """Write something down."""


@skill()
def go_home(goal: GoalHandle) -> None:
    """Drive home."""


class Writer(Eloquent):
    """Keeps the grammar that it should have obeyed."""

    grammar = ""

    def generate(self, *_: object, grammar: str, **more: Any) -> Iterator[str]:
        self.grammar = grammar
        yield from self._pieces


def understand(model: Writer, logit: float) -> Meaning | None:
    agent = Agent("robot", "", SkillSet([take_note, go_home]))
    judge = Decider(CertainEncoder(logit), read_head())
    interpreter = Interpreter([agent], Bus(), SystemClock(), model, decider=judge)
    return interpreter.understand(SAID, Turn(1, Bus(), SystemClock(), on_speech=lambda: None))


def test_of_an_order_a_model_fills_in_the_words_and_somebody_is_asked_first() -> None:
    meaning = understand(Writer(NOTED), ORDER)

    assert meaning is not None
    assert meaning.calls == (Call("take_note", {"text": "the milk is empty"}),)
    assert (meaning.source, meaning.sure) == ("model", False)


@pytest.mark.parametrize(
    ("writes", "logit"),
    [
        (NOTED, TALK),
        ('call: take_note(text="the kitchen is on fire"); done', ORDER),
        ("call: go_home(); done", ORDER),
    ],
    ids=["of what is no order", "with words that nobody said", "a skill without free words"],
)
def test_no_other_call_of_a_model_counts(writes: str, logit: float) -> None:
    assert understand(Writer(writes), logit) is None


def test_the_grammar_allows_only_the_calls_that_take_any_words() -> None:
    model = Writer("talk: Fine.")
    understand(model, ORDER)

    assert Matcher(model.grammar).accept(NOTED) == len(NOTED)
    assert Matcher(model.grammar).accept("call: go_home") < len("call: go_home")


def test_of_what_is_neither_an_order_nor_a_general_question_no_model_is_asked() -> None:
    model = Writer("talk: Fine.")
    understand(model, TALK)

    assert not model.grammar
