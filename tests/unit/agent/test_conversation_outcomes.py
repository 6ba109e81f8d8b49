"""What the conversation says became of a turn, and who interrupted it."""

import threading
from collections.abc import Iterator

from guards import HUNG_S
from support.conversation import Eloquent, Talk

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.protocol import SAY
from edgevox.core.commands import Interrupt, Reset, Speak, TextInput
from edgevox.core.events import Cause, Interrupted, Outcome, TokenGenerated, TurnEnded


class Model(Eloquent):
    """Says its pieces, then fails or waits for the end if it is told to."""

    def __init__(self, *pieces: str, fails: bool = False, waits: bool = False) -> None:
        super().__init__(*pieces)
        self.fails, self.waits = fails, waits
        self.begun = threading.Event()

    def generate(self, messages, *, grammar, max_tokens, token) -> Iterator[str]:
        self.begun.set()
        yield from self._pieces
        if self.fails:
            raise ModelFailed("out of memory")
        if self.waits:
            token.wait(HUNG_S)


class Rig(Talk):
    def __init__(self, model: Model | None = None) -> None:
        super().__init__(skills=("dance",), model=model)
        self.causes: list[Cause] = []
        self.bus.subscribe(Interrupted, lambda event: self.causes.append(event.cause))

    def outcome(self, text: str) -> Outcome:
        before = len(self.outcomes)
        self.answers_to(TextInput(text))
        (found,) = filter(None, self.outcomes[before:])
        return found


def test_plain_commands_are_acted_on_and_all_else_is_not_understood() -> None:
    with Rig() as one:
        assert one.outcome("do your dance") is Outcome.ACTED
        assert one.outcome("what is love") is Outcome.NOT_UNDERSTOOD
        assert one.outcome("dance " * 3000) is Outcome.REFUSED
        assert one.outcome("   ") is Outcome.NOT_UNDERSTOOD


def test_a_model_answers_or_fails_and_all_its_pieces_count() -> None:
    with Rig(Model(SAY, "Hello. ", "World. ")) as answering:
        assert answering.outcome("what is love") is Outcome.ANSWERED
        (end,) = [one for one in answering.of(TurnEnded) if one.outcome]
        assert end.tokens == 3
        assert len(answering.of(TokenGenerated)) < end.tokens, "the first is not spoken"

    with Rig(Model(SAY, "Hello. ", fails=True)) as failing:
        assert failing.outcome("what is love") is Outcome.FAILED


def test_what_is_cut_was_interrupted_whatever_it_said_before() -> None:
    model = Model(SAY, "Hello. ", waits=True)
    with Rig(model) as one:
        one.conversation.submit(TextInput("what is love"))
        assert model.begun.wait(HUNG_S)
        one.conversation.submit(Interrupt(cause=Cause.BARGE_IN, motion=False))
        one.settle()

        assert [*filter(None, one.outcomes)] == [Outcome.INTERRUPTED]
        assert one.causes == [Cause.BARGE_IN]


def test_what_nobody_asked_for_in_words_has_no_outcome() -> None:
    with Rig() as one:
        one.conversation.submit(Speak("Good morning."))
        one.conversation.submit(Reset())
        one.settle()

        assert set(one.outcomes) == {None}
        assert one.causes == [Cause.RESET]
