"""The question that stands: "Shall I go to the kitchen?", from its asking to its one end."""

import threading
from dataclasses import dataclass

from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import AskedCall, Confirmation, ConfirmationStatus
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock

EXPIRES_S = 20.0
"""How long a question stands after it was said to its end."""

_LAPSES = (ConfirmationStatus.EXPIRED, ConfirmationStatus.CANCELLED)


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked in which turn, and what is done if the answer is yes."""

    meaning: Meaning
    text: str
    turn: int


class OpenQuestion:
    """Holds the one question that stands, and tells on the bus what becomes of it.

    It is asked and answered on one thread; `cancel` may be called from any. A question of a turn
    that was cancelled cannot be asked any more, so that nothing said after a stop answers it.
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
        """The one that stands."""
        return self._question

    @property
    def awaits(self) -> bool:
        """Whether a yes could only be meant for a question, though maybe one that stands no more.

        So it is until something else is said after a question that expired or was cancelled.
        """
        return self._question is not None or self._lapsed

    @property
    def expires_in_s(self) -> float | None:
        """How long it still stands; None if there is none, or it is not said to its end."""
        at_s = self._expires_at_s
        return None if at_s is None else max(0.0, at_s - self._clock.now())

    def ask(self, question: Question) -> bool:
        """Let it stand instead of any other; False if its turn was cancelled meanwhile."""
        self.end(ConfirmationStatus.REPLACED)
        with self._lock:
            if question.turn <= self._cancelled_turn:
                return False
            self._question, self._begun_s, self._expires_at_s = question, None, None
        self._tell(question, ConfirmationStatus.ASKED)
        return True

    def said(self, turn: Turn) -> None:
        """The turn is over; if it asked, its question expires from now on.

        One that nobody could notice, since it was cut before, is not asked.
        """
        with self._lock:
            asked = self._question is not None and self._question.turn == turn.number
            if asked and turn.noticed_s is not None:
                self._begun_s = turn.noticed_s
                self._expires_at_s = self._clock.now() + EXPIRES_S
        if asked and turn.noticed_s is None:
            self.end(ConfirmationStatus.CANCELLED)

    def is_answered_at(self, said_s: float) -> bool:
        """Whether what was said at this time can answer it: after it began, and not too late."""
        with self._lock:
            begun_s, at_s = self._begun_s, self._expires_at_s
            if begun_s is None or at_s is None:
                return False
            return begun_s <= said_s and self._clock.now() < at_s

    def expire(self) -> None:
        """End it if its time is over."""
        if self.expires_in_s == 0.0:
            self.end(ConfirmationStatus.EXPIRED)

    def end(self, status: ConfirmationStatus) -> Question | None:
        """It is over; the one that was, for whoever ended it: only one does."""
        with self._lock:
            question = self._take()
            self._lapsed = question is not None and status in _LAPSES
        if question:
            self._tell(question, status)
        return question

    def cancel(self, turn: int) -> Question | None:
        """It is over, and this turn and those before ask nothing. Told by `tell_cancelled`.

        Publishes nothing, so that it can be called where nothing may block.
        """
        with self._lock:
            self._cancelled_turn = max(self._cancelled_turn, turn)
            self._lapsed |= self._question is not None
            return self._take()

    def tell_cancelled(self, question: Question | None) -> None:
        """Say of one that was cancelled that it is."""
        if question:
            self._tell(question, ConfirmationStatus.CANCELLED)

    def _take(self) -> Question | None:
        question, self._question = self._question, None
        self._begun_s = self._expires_at_s = None
        return question

    def _tell(self, question: Question, status: ConfirmationStatus) -> None:
        calls = tuple(AskedCall(call.skill, call.arguments) for call in question.meaning.every_call)
        self._bus.publish(Confirmation(status, question.text, calls, EXPIRES_S, turn=question.turn))
