"""The turn, one exchange with a person: its cancel token, its times and its spoken answer.

`StateMachine` holds the state of the conversation, with its transitions written down.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from sentence_stream import SentenceBoundaryDetector

from edgevox.agent.skills import Call
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.commands import Hypothesis, Rate, Way
from edgevox.core.events import (
    Decided,
    Outcome,
    Responded,
    SentenceReady,
    State,
    StateChanged,
    TokenGenerated,
    TurnMeasured,
)
from edgevox.core.speech import Spoken, TextToSpeech, Utterance


@dataclass(frozen=True, slots=True)
class InputTiming:
    """Times of the input that began a turn."""

    at_s: float | None = None
    """The clock's time when the input ended; None for the moment in which the turn began."""
    stt_s: float = 0.0
    """Seconds that speech recognition took."""


class Turn:
    """Owns a `CancelToken` and a stopwatch, and speaks the turn's answer.

    Sentences go onto the bus and, if there is one, to the speech output. The turn says nothing once
    its token is cancelled.
    """

    def __init__(
        self,
        number: int,
        bus: Bus,
        clock: Clock,
        on_speech: Callable[[], object],
        *,
        speech_output: TextToSpeech | None = None,
        asked: InputTiming | None = None,
        way: Way = Way.TEXT_INPUT,
        mark: int = 0,
        plainly: bool = False,
        doubted: bool = False,
        hearing: float = 1.0,
        others: Sequence[Hypothesis] = (),
        rate: Rate | None = None,
    ) -> None:
        """Begin the turn's stopwatch.

        Args:
            number: The turn's number on the bus, from 1 on.
            bus: Carries the turn's sentences and measurements.
            clock: Measures the turn.
            on_speech: Called when the first sentence can be noticed: heard, or read if nothing is
                spoken.
            speech_output: Speaks the sentences; None to only write them.
            asked: Times of the input; None if it ended just now.
            way: How the turn was asked for.
            mark: The interlock's mark at that time: after a later stop or release the turn may not
                move anything.
            plainly: True if a stop word was heard in the same breath: then only a plain order may
                move anything without a question.
            doubted: True if a stop word was heard at the end of the words or right after them:
                then nothing may move without a question.
            hearing: Confidence that the words were said, from 0 to 1.
            others: Other words that may have been said, the likeliest first.
            rate: Rates texts by the sound of what was said, if its words are not sure.
        """
        self.number = number
        self.way = way
        self.mark = mark
        self.plainly = plainly
        self.doubted = doubted
        self.hearing = hearing
        self.others = others
        self.rate = rate
        self.token = CancelToken()
        self.tokens = 0
        self._bus = bus
        self._clock = clock
        self._on_speech = on_speech
        self._speech_output = speech_output
        self._utterance: Utterance | None = None
        self._sentences = SentenceBoundaryDetector()
        self._said: list[str] = []
        self._detail = ""
        self._spoken: Spoken | None = None
        asked = asked or InputTiming()
        self._asked_s = clock.now() if asked.at_s is None else asked.at_s
        self._stt_s = asked.stt_s
        self._first_s: float | None = None
        self._model_s = 0.0
        self._outcome = Outcome.ANSWERED

    @property
    def asked_s(self) -> float:
        """The clock's time when the input that this turn answers ended."""
        return self._asked_s

    @property
    def outcome(self) -> Outcome:
        """The outcome of the turn; `INTERRUPTED` if it was `cut`."""
        return Outcome.INTERRUPTED if self.cut else self._outcome

    @property
    def text(self) -> str:
        """The answer so far; after `settle`, only the part that could really be heard."""
        return " ".join(self._said) if self._spoken is None else self._spoken.text

    @property
    def noticed_s(self) -> float | None:
        """The clock's time when the answer could first be noticed; None before that.

        With speech output, the time is known only after `settle`.
        """
        return self._first_s

    @property
    def cut(self) -> bool:
        """True if the turn was ended before the whole answer was said."""
        return self.token.cancelled or (self._spoken is not None and self._spoken.cut)

    def stream(self, piece: str, tokens: int = 1) -> None:
        """Say a piece of an answer as a model generates it.

        An empty piece stands for a token that is not spoken; it is only counted. Text that was held
        back had its tokens counted already.
        """
        self.tokens += tokens
        if self.token.cancelled or not piece:
            return
        self._bus.publish(TokenGenerated(piece, self.number))
        for sentence in self._sentences.add_chunk(piece):
            self._say(sentence)

    def say(self, text: str, outcome: Outcome | None = None, *, detail: str = "") -> None:
        """Say a whole text. `outcome` sets the turn's outcome; `detail` is only written."""
        self._outcome = outcome or self._outcome
        self.write(detail)
        for sentence in self._sentences.add_chunk(text + " "):
            self._say(sentence)
        self.flush()

    def write(self, detail: str) -> None:
        """Set the text that is written beside the answer and not said."""
        self._detail = detail or self._detail

    def flush(self) -> None:
        """Say the rest of the answer so far, which still waited for the end of its sentence."""
        rest = self._sentences.finish().strip()
        if rest:
            self._say(rest)

    def acted(self) -> None:
        """Record that the turn called skills."""
        self._outcome = Outcome.ACTED

    def decided(self, calls: Sequence[Call], stage: str, confidence: float) -> None:
        """Publish what the words were understood as, by which stage, and how sure it is."""
        told = tuple((call.skill, call.arguments) for call in calls)
        self._bus.publish(Decided(told, stage, confidence, self.number))

    def thought(self, seconds: float) -> None:
        """Add seconds that a model worked for this turn."""
        self._model_s += seconds

    def settle(self) -> None:
        """Say the rest of the answer, and wait until all is said or cut."""
        if self._spoken is not None:
            return
        if not self.token.cancelled:
            self.flush()
        if self._utterance is None:
            return
        self._spoken = self._utterance.finish()
        if self._spoken.first_audible_s is not None:
            self._first_s = self._spoken.first_audible_s

    def finish(self, *, measured: bool) -> None:
        """Publish the full answer, if there was any, and the turn's times if `measured`."""
        self.settle()
        if self._said:
            detail = "" if self.cut else self._detail
            self._bus.publish(Responded(self.text, self.number, cut=self.cut, detail=detail))
        if not measured:
            return
        total = self._clock.now() - self._asked_s
        self._bus.publish(
            TurnMeasured(
                stt=self._stt_s,
                llm=self._model_s,
                tts=self._spoken.synthesis_s if self._spoken else 0.0,
                ttfs=total if self._first_s is None else self._first_s - self._asked_s,
                total=total,
                turn=self.number,
            )
        )

    def _say(self, sentence: str) -> None:
        if self.token.cancelled:
            return
        if not self._said:
            self._begin()
        self._said.append(sentence)
        self._bus.publish(SentenceReady(sentence, self.number))
        if self._utterance is not None:
            self._utterance.say(sentence)

    def _begin(self) -> None:
        if self._speech_output is not None:
            self._utterance = self._speech_output.begin(self.token, self._on_speech)
            return
        self._first_s = self._clock.now()
        self._on_speech()


TRANSITIONS: Mapping[State, frozenset[State]] = {
    State.LISTENING: frozenset(
        {State.TRANSCRIBING, State.THINKING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.TRANSCRIBING: frozenset(
        {State.LISTENING, State.THINKING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.THINKING: frozenset(
        {State.LISTENING, State.TRANSCRIBING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.SPEAKING: frozenset({State.LISTENING, State.TRANSCRIBING, State.INTERRUPTED}),
    State.INTERRUPTED: frozenset(
        {State.LISTENING, State.TRANSCRIBING, State.THINKING, State.SPEAKING}
    ),
}
"""The states that may follow each state. A turn thinks, then speaks, and never thinks again after
that. A turn that is cut goes through `interrupted`; a turn that ends goes back to `listening`, or
to `transcribing` if a person has spoken meanwhile."""

_IDLE = frozenset({State.LISTENING, State.INTERRUPTED})


class StateMachine:
    """Holds the state and publishes its changes, in their order. Any thread may use it."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._state = State.LISTENING
        self._unheard = 0
        self.gate = threading.RLock()
        """Held while the state changes; hold it to do something together with a change."""

    @property
    def state(self) -> State:
        """The state now."""
        return self._state

    @property
    def transcribes(self) -> bool:
        """True while an utterance is being transcribed, in any state."""
        return self._unheard > 0

    def start(self) -> None:
        """Publish the first state."""
        self._bus.publish(StateChanged(self._state))

    def enter(self, state: State, turn: Turn | None = None) -> bool:
        """Enter `state` if the transition exists and the turn is not cut; return whether it did."""
        with self.gate:
            late = turn is not None and turn.token.cancelled and state is not State.INTERRUPTED
            if late or state not in TRANSITIONS[self._state]:
                return False
            self._state = state
            self._bus.publish(StateChanged(state, turn.number if turn else 0))
            return True

    def rest(self) -> None:
        """Return to `listening`, or to `transcribing` while an utterance is transcribed."""
        with self.gate:
            self.enter(State.TRANSCRIBING if self._unheard else State.LISTENING)

    def transcribing(self) -> None:
        """Count an utterance whose transcription has begun."""
        with self.gate:
            self._unheard += 1
            if self._state in _IDLE:
                self.enter(State.TRANSCRIBING)

    def transcribed(self, *, words: bool) -> None:
        """Count off a transcribed utterance; without `words` the conversation listens again."""
        with self.gate:
            self._unheard = max(0, self._unheard - 1)
            if not words and self._state is State.TRANSCRIBING:
                self.rest()
