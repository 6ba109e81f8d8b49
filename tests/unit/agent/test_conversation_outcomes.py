"""What the conversation says became of a turn, and who interrupted it."""

import threading
from collections.abc import Iterator

import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.grammar import SAY
from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, Reset, Speak, TextInput
from edgevox.core.events import Cause, Interrupted, Outcome, TokenGenerated, TurnEnded


@skill(templates=["wave"], says="Waving.")
def wave(goal) -> None:
    """Wave."""


class Model:
    """Says its pieces, then fails or waits for the end if it is told to."""

    name, context_tokens = "model", 4096

    def __init__(self, *pieces: str, fails: bool = False, waits: bool = False) -> None:
        self.pieces, self.fails, self.waits = pieces, fails, waits
        self.begun = threading.Event()

    def generate(self, messages, *, grammar, max_tokens, token) -> Iterator[str]:
        self.begun.set()
        yield from self.pieces
        if self.fails:
            raise ModelFailed("out of memory")
        if self.waits:
            token.wait(60)

    def count_tokens(self, text: str) -> int:
        return len(text.split())


class Rig:
    def __init__(self, model: Model | None = None) -> None:
        self.ends: list[TurnEnded] = []
        self.causes: list[Cause] = []
        self.pieces: list[str] = []
        bus = Bus()
        bus.subscribe(TurnEnded, self.ends.append)
        bus.subscribe(Interrupted, lambda event: self.causes.append(event.cause))
        bus.subscribe(TokenGenerated, lambda event: self.pieces.append(event.text))
        agents = [Agent("robot", "Be brief.", SkillSet([wave]))]
        self.conversation = Conversation(agents, bus, halt=lambda _: False, model=model)
        self.conversation.start()

    def outcome(self, text: str) -> Outcome | None:
        self.ends.clear()
        self.conversation.submit(TextInput(text))
        assert self.conversation.wait_idle(20)
        (found,) = [end.outcome for end in self.ends if end.outcome]
        return found


@pytest.fixture
def rig() -> Iterator[type[Rig]]:
    made: list[Rig] = []

    class Made(Rig):
        def __init__(self, model: Model | None = None) -> None:
            super().__init__(model)
            made.append(self)

    yield Made
    for one in made:
        one.conversation.close()


def test_plain_commands_are_acted_on_and_all_else_is_not_understood(rig) -> None:
    one = rig()

    assert one.outcome("wave") is Outcome.ACTED
    assert one.outcome("what is love") is Outcome.NOT_UNDERSTOOD
    assert one.outcome("wave " * 3000) is Outcome.REFUSED
    assert one.outcome("   ") is Outcome.NOT_UNDERSTOOD


def test_a_model_answers_or_fails_and_all_its_pieces_count(rig) -> None:
    answering = rig(Model(SAY, "Hello. ", "World. "))
    assert answering.outcome("what is love") is Outcome.ANSWERED
    (end,) = [one for one in answering.ends if one.outcome]
    assert end.tokens == 3
    assert len(answering.pieces) < end.tokens, "the first is not spoken"

    failing = rig(Model(SAY, "Hello. ", fails=True))
    assert failing.outcome("what is love") is Outcome.FAILED


def test_what_is_cut_was_interrupted_whatever_it_said_before(rig) -> None:
    model = Model(SAY, "Hello. ", waits=True)
    one = rig(model)
    one.conversation.submit(TextInput("what is love"))
    assert model.begun.wait(60)
    one.conversation.submit(Interrupt(cause=Cause.BARGE_IN, motion=False))
    assert one.conversation.wait_idle(20)

    assert [end.outcome for end in one.ends if end.outcome] == [Outcome.INTERRUPTED]
    assert one.causes == [Cause.BARGE_IN]


def test_what_nobody_asked_for_in_words_has_no_outcome(rig) -> None:
    one = rig()
    one.conversation.submit(Speak("Good morning."))
    one.conversation.submit(Reset())
    assert one.conversation.wait_idle(20)

    assert {end.outcome for end in one.ends} == {None}
    assert one.causes == [Cause.RESET]
