"""The open question, such as "Shall I go to the kitchen?", from its asking to its one end."""

import threading
from dataclasses import dataclass

from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import AskedCall, Confirmation, ConfirmationStatus
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock

EXPIRES_S = 20.0
"""Seconds that a question stays open after it was said to its end."""

_LAPSES = (ConfirmationStatus.EXPIRED, ConfirmationStatus.CANCELLED)


@dataclass(frozen=True, slots=True)
class Question:
    """A yes-or-no question, or one with several meanings to choose from."""

    meaning: Meaning
    """The meaning that a yes carries out."""
    text: str
    """The question as it is said."""
    turn: int
    """Number of the turn that asks."""
    others: tuple[Meaning, ...] = ()
    """The other meanings to choose; a yes then chooses none."""
    sentences: tuple[str, ...] = ()
    """The sentences of all meanings to choose."""


class OpenQuestion:
    """Holds the one open question and publishes its changes.

    One thread asks and answers it; `cancel` may be called from any. A cancelled turn cannot ask any
    more, so that words after a stop never answer its question.
    """

    def __init__(self, bus: Bus, clock: Clock) -> None:
        self._bus = bus
        self._clock = clock
        self._lock = threading.Lock()
        self._question: Question | None = None
        self._begun_s: float | None = None
        self._expires_at_s: float | None = None
        self._cancelled_turn = 0
        self._lapsed = False

    @property
    def asked(self) -> Question | None:
        """The open question, or None."""
        return self._question

    @property
    def awaits(self) -> bool:
        """True if a yes can only mean a question, open or lapsed.

        A question that expired or was cancelled counts as lapsed until other words follow.
        """
        return self._question is not None or self._lapsed

    @property
    def expires_in_s(self) -> float | None:
        """Seconds until the question expires; None without one, and before it was fully said."""
        at_s = self._expires_at_s
        return None if at_s is None else max(0.0, at_s - self._clock.now())

    def ask(self, question: Question) -> bool:
        """Open this question in place of any other; False if its turn was cancelled."""
        self.end(ConfirmationStatus.REPLACED)
        with self._lock:
            if question.turn <= self._cancelled_turn:
                return False
            self._question, self._begun_s, self._expires_at_s = question, None, None
        self._tell(question, ConfirmationStatus.ASKED)
        return True

    def said(self, turn: Turn) -> None:
        """Tell that a turn is over; if it asked, its question's time runs from now on.

        A question that was cut before a person could notice it is cancelled.
        """
        with self._lock:
            asked = self._question is not None and self._question.turn == turn.number
            if asked and turn.noticed_s is not None:
                self._begun_s = turn.noticed_s
                self._expires_at_s = self._clock.now() + EXPIRES_S
        if asked and turn.noticed_s is None:
            self.end(ConfirmationStatus.CANCELLED)

    def is_answered_at(self, said_s: float) -> bool:
        """True if words said at this time can answer: the question had begun and is still open."""
        with self._lock:
            begun_s, at_s = self._begun_s, self._expires_at_s
            if begun_s is None or at_s is None:
                return False
            return begun_s <= said_s and self._clock.now() < at_s

    def expire(self) -> None:
        """End the question if its time is over."""
        if self.expires_in_s == 0.0:
            self.end(ConfirmationStatus.EXPIRED)

    def end(self, status: ConfirmationStatus) -> Question | None:
        """End the question and return it; None if another thread has ended it."""
        with self._lock:
            question = self._take()
            self._lapsed = question is not None and status in _LAPSES
        if question:
            self._tell(question, status)
        return question

    def cancel(self, turn: int) -> Question | None:
        """Cancel the question; this turn and those before it can ask nothing more.

        Publishes nothing, so that it never blocks: pass the result to `tell_cancelled`.
        """
        with self._lock:
            self._cancelled_turn = max(self._cancelled_turn, turn)
            self._lapsed |= self._question is not None
            return self._take()

    def tell_cancelled(self, question: Question | None) -> None:
        """Publish that this question was cancelled."""
        if question:
            self._tell(question, ConfirmationStatus.CANCELLED)

    def _take(self) -> Question | None:
        question, self._question = self._question, None
        self._begun_s = self._expires_at_s = None
        return question

    def _tell(self, question: Question, status: ConfirmationStatus) -> None:
        meanings = (question.meaning, *question.others)
        calls = tuple(
            AskedCall(call.skill, call.arguments) for one in meanings for call in one.every_call
        )
        self._bus.publish(Confirmation(status, question.text, calls, EXPIRES_S, turn=question.turn))
