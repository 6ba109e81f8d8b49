"""What a model may call: skills that take any words, asked for by an order that holds the words."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.llm.language_model import ChatMessage
from edgevox.agent.llm.remote.gbnf import Matcher
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder.packed_file import Floats
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning, read_head
from edgevox.agent.skills import Call, GoalHandle, SkillSet, skill
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock

ORDER, TALK = 12.0, -12.0
SAID = "jot down that the milk is empty"
NOTED = 'call: take_note(text="the milk is empty"); done'


@skill()
def take_note(goal: GoalHandle, text: str) -> None:
    """Write something down."""


@skill()
def go_home(goal: GoalHandle) -> None:
    """Drive home."""


class Judge:
    """Takes every sentence for an order, or none."""

    def __init__(self, logit: float) -> None:
        head = read_head()
        weights = head.order_weights
        self._features = weights * (logit - head.order_bias) / float(weights @ weights)

    def features(self, text: str) -> Floats:
        return np.asarray(self._features, np.float32)


class Writer:
    """A model that writes what it was told to, and keeps the grammar that it should have obeyed."""

    name, context_tokens = "writer", 4096

    def __init__(self, writes: str) -> None:
        self._writes = writes
        self.grammar = ""

    def generate(
        self, messages: Sequence[ChatMessage], *, grammar: str, max_tokens: int, token: object
    ) -> Iterator[str]:
        self.grammar = grammar
        yield self._writes

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None: ...

    def count_tokens(self, text: str) -> int:
        return len(text)

    def close(self) -> None: ...


def understand(model: Writer, logit: float) -> Meaning | None:
    agent = Agent("robot", "", SkillSet([take_note, go_home]))
    judge = Decider(Judge(logit), read_head())
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


@pytest.mark.parametrize(("logit", "allowed"), [(ORDER, True), (TALK, False)])
def test_the_grammar_allows_a_call_only_to_an_order(logit: float, allowed: bool) -> None:
    model = Writer("talk: Fine.")
    understand(model, logit)

    matcher = Matcher(model.grammar)
    assert (matcher.accept(NOTED) == len(NOTED)) is allowed
    assert Matcher(model.grammar).accept("call: go_home") < len("call: go_home")
