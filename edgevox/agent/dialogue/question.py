"""The open question, such as "Shall I go to the kitchen?", from its asking to its one end.

A countdown ("I will go to the kitchen.") is one as well, which is done when its time is over.

`FollowUps` tells what a person may say without the wake word, shortly after the robot spoke. People
do not say a name again to answer a question. But in a room with a television or with other people,
most words after an answer are not for the robot: only those count that answer its question, correct
it or are a plain command.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass

from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import AskedCall, Confirmation, ConfirmationStatus, ToolCalled
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.commands import Heard, Way

EXPIRES_S = 20.0
"""Seconds that a question stays open after it was said to its end."""
COUNTDOWN_S = 1.0
"""Seconds that a person has to say no after the robot said what it will do."""
SPOKEN_S = 8.0
"""Seconds that a countdown waits for the words of somebody who began to speak."""

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
    goes: bool = False
    """True for a countdown: the text says what the robot will do, and it does so when the time is
    over, unless a person says anything but yes."""
    way: Way = Way.TEXT_INPUT
    """The way in which a countdown's words came."""
    mark: int = 0
    """The interlock's mark when they were said: after a later stop a countdown moves nothing."""


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
        self._spoken = False
        bus.subscribe(ToolCalled, self._on_call)

    def _on_call(self, _: ToolCalled) -> None:
        """Another order ends a countdown, by whatever way it came."""
        if self.counts_down:
            self.end(ConfirmationStatus.REPLACED)

    @property
    def counts_down(self) -> bool:
        """True while the robot is to do what it said, unless a person says no."""
        question = self._question
        return question is not None and question.goes

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
            self._spoken = False
        self._tell(question, ConfirmationStatus.ASKED)
        return True

    def said(self, turn: Turn) -> None:
        """Tell that a turn is over; if it asked, its question's time runs from now on.

        A question that was cut before a person could notice it is cancelled.
        """
        with self._lock:
            asked = self._question is not None and self._question.turn == turn.number
            if self._question and asked and turn.noticed_s is not None:
                self._begun_s = turn.noticed_s
                open_s = COUNTDOWN_S if self._question.goes else EXPIRES_S
                self._expires_at_s = self._clock.now() + open_s
                if self._question.goes and (turn.cut or self._spoken):
                    self._wait_for_words()
        if asked and turn.noticed_s is None:
            self.end(ConfirmationStatus.CANCELLED)

    def spoken(self) -> None:
        """Somebody began to speak: a countdown waits for the words. Any thread."""
        with self._lock:
            if self._question and self._question.goes:
                self._spoken = True
                if self._expires_at_s is not None:
                    self._wait_for_words()

    def _wait_for_words(self) -> None:
        self._spoken, self._expires_at_s = True, self._clock.now() + SPOKEN_S

    @property
    def due(self) -> Question | None:
        """The countdown whose time is over, or None."""
        question = self._question
        return question if question and question.goes and self.expires_in_s == 0.0 else None

    def take_due(self) -> tuple[Question, bool] | None:
        """End the countdown whose time is over; it, and whether words were awaited in vain."""
        with self._lock:
            question, spoken = self.due, self._spoken
            if question is None:
                return None
            self._take()
        ended = ConfirmationStatus.EXPIRED if spoken else ConfirmationStatus.COUNTED_DOWN
        self._tell(question, ended)
        return question, spoken

    def is_answered_at(self, said_s: float) -> bool:
        """True if words said at this time can answer: the question had begun and is still open."""
        with self._lock:
            begun_s, at_s = self._begun_s, self._expires_at_s
            if begun_s is None or at_s is None:
                return False
            return begun_s <= said_s and self._clock.now() < at_s

    def expire(self) -> None:
        """End the question if its time is over; a countdown ends by `take_due`."""
        if self.expires_in_s == 0.0 and not self.due:
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
        self._spoken = False
        return question

    def _tell(self, question: Question, status: ConfirmationStatus) -> None:
        meanings = (question.meaning, *question.others)
        calls = tuple(
            AskedCall(call.skill, call.arguments) for one in meanings for call in one.every_call
        )
        open_s = COUNTDOWN_S if question.goes else EXPIRES_S
        self._bus.publish(
            Confirmation(
                status, question.text, calls, open_s, turn=question.turn, goes=question.goes
            )
        )


class FollowUps:
    """Implements `core.speech.FollowUp` for a conversation. Any thread may use it.

    `follows` tells whether words answer, correct or command. `within_s` is
    how long after a spoken answer they may begin; 0 turns all follow-ups off, except while the
    robot counts down: then any words count. A question takes answers for as long as it is open.
    Only words that were spoken to the robot are answered so: after typed ones nobody is near.
    """

    def __init__(
        self,
        question: OpenQuestion,
        follows: Callable[[Heard], bool],
        clock: Clock,
        *,
        within_s: float,
    ) -> None:
        self._question = question
        self._follows = follows
        self._clock = clock
        self._within_s = within_s
        self.close()

    def open(self, *, asked: bool) -> None:
        """Await a follow-up from now on: a spoken turn is over; `asked` if it asked a question."""
        self._answered_s, self._asked = self._clock.now(), asked

    def close(self) -> None:
        """Await none: the robot was stopped."""
        self._answered_s, self._asked = float("-inf"), False

    def begins(self) -> None:
        """See `FollowUp.begins`: a countdown waits for the words."""
        self._question.spoken()

    def awaits(self, began_s: float, ended_s: float) -> bool:
        """See `FollowUp.awaits`."""
        if self.asked(ended_s):
            return True
        if not self._within_s:
            return False
        return self._answered_s <= began_s <= self._answered_s + self._within_s

    def asked(self, ended_s: float) -> bool:
        """See `FollowUp.asked`."""
        if self._question.counts_down:
            return True
        return bool(self._within_s) and self._asked and self._question.is_answered_at(ended_s)

    def takes(self, heard: Heard) -> bool:
        """See `FollowUp.takes`."""
        return self.awaits(heard.first_s, heard.ended_s) and self._follows(heard)
