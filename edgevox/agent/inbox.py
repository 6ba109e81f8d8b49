"""What waits for the conversation's thread: no more than so many, each of a bounded length."""

import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, replace

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.errors import Refusal
from edgevox.core.files.text import MAX_CHARACTERS, clean
from edgevox.core.log import get_logger
from edgevox.core.ways import Way

log = get_logger(__name__)

MAX_WAITING = 64
"""How many utterances may wait. One more is refused; a stop never is."""
LIMITS: Mapping[Refusal, int] = {
    Refusal.TOO_LONG: MAX_CHARACTERS,
    Refusal.TOO_MANY: MAX_WAITING,
}
"""Why something that is asked may not be taken, and how much is."""


@dataclass(frozen=True, slots=True)
class Announce:
    """Something to say that nobody asked for now: a goal ended, the robot stopped.

    `detail` belongs to it, and is only written.
    """

    text: str
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Forget:
    """Forget what was said, between turns."""


@dataclass(frozen=True, slots=True)
class Settle:
    """Say that the conversation listens again, after a stop that cut no turn."""


@dataclass(frozen=True, slots=True)
class SwitchLanguage:
    """Understand another language, between turns."""

    code: str


@dataclass(frozen=True, slots=True)
class TooLong:
    """Words that are more than is taken, `length` characters; `beginning` is kept of them.

    `asked` says whether they were for the agent, or to be said aloud.
    """

    length: int
    beginning: str
    asked: bool


Item = TextInput | Heard | Speak | RunSkill | TooLong | Announce | Forget | Settle | SwitchLanguage


@dataclass(frozen=True, slots=True)
class _Waiting:
    """An item, the clock's time when it was put, and the interlock's mark when it was asked for."""

    item: Item
    put_s: float
    mark: int


_ASKED = TextInput | Heard | Speak | RunSkill
_HOUSEKEEPING = Forget | Settle | SwitchLanguage


class Inbox:
    """A queue in the order of asking: anybody puts, one thread takes and is then at work.

    `gate` is held while it changes; hold it to do something together with a change. `since_s` is
    the clock's time when what was taken last had been put, `mark` is what it was put with: the
    mark of the interlock when it was asked for.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self.gate = threading.Condition()
        self.since_s = 0.0
        self.mark = 0
        self._clock = clock or SystemClock()
        self._items: deque[_Waiting] = deque()
        self._at_work = False
        self._closed = False
        self.refusals = Counter({str(reason): 0 for reason in LIMITS})

    @property
    def closed(self) -> bool:
        """Whether nothing is taken any more."""
        return self._closed

    @property
    def idle(self) -> bool:
        """Whether nothing waits and nobody is at work."""
        with self.gate:
            return not (self._items or self._at_work)

    def put(self, item: Item, mark: int = 0) -> Refusal | None:
        """Let it wait; else why not, which is counted and logged.

        What is too long is told so in its turn.
        """
        with self.gate:
            refusal = None if self._closed else self._put(item, mark)
            self.gate.notify_all()
        if refusal:
            log.warning("request_refused", reason=refusal, limit=LIMITS[refusal])
        return refusal

    def announce(self, text: str, detail: str = "") -> None:
        """Have something said that nobody asked for now, and `detail` written beside it."""
        self.put(Announce(text, detail))

    def take(self, timeout_s: float | None = None) -> Item | None:
        """The next one, once there is one; None when it is closed, and after the timeout.

        Who takes is at work.
        """
        with self.gate:
            self.gate.wait_for(lambda: self._items or self._closed, timeout_s)
            if self._closed or not self._items:
                return None
            self._at_work = True
            taken = self._items.popleft()
            self.since_s, self.mark = taken.put_s, taken.mark
            return taken.item

    def done(self) -> None:
        """What was taken is attended to."""
        with self.gate:
            self._at_work = False
            self.gate.notify_all()

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until nothing waits and nobody is at work; False after the timeout."""
        with self.gate:
            return self.gate.wait_for(lambda: self.idle, timeout_s)

    def withdraw(self, ended_s: float) -> None:
        """Forget what was heard until then, if it still waits."""
        with self.gate:
            gone = [one for one in self._items if getattr(one.item, "ended_s", None) == ended_s]
            for one in gone:
                self._items.remove(one)

    def stop(self) -> None:
        """Forget all that is to be said and done; who is forgotten and what is spoken stays."""
        with self.gate:
            kept = [one for one in self._items if isinstance(one.item, SwitchLanguage | Forget)]
            self._items = deque({type(one.item): one for one in kept}.values())

    def remark(self, mark: int) -> None:
        """Let all that waits count as asked for at this mark: it came after what is done now."""
        with self.gate:
            self._items = deque(replace(one, mark=mark) for one in self._items)

    def close(self) -> None:
        """Forget everything, and take nothing any more."""
        with self.gate:
            self._closed = True
            self._items.clear()
            self.gate.notify_all()

    def _put(self, item: Item, mark: int) -> Refusal | None:
        if isinstance(item, _ASKED) and len(self._items) >= MAX_WAITING:
            return self._refuse(Refusal.TOO_MANY)
        last = self._items[-1].item if self._items else None
        if isinstance(item, _HOUSEKEEPING) and type(last) is type(item):
            self._items.pop()  # of two on end only the last one counts
        bounded = _bounded(item)
        self._items.append(_Waiting(bounded, self._clock.now(), mark))
        return self._refuse(Refusal.TOO_LONG) if isinstance(bounded, TooLong) else None

    def _refuse(self, reason: Refusal) -> Refusal:
        self.refusals[reason] += 1
        return reason


def asked_in_words(item: Item) -> bool:
    """Whether somebody wants an answer to this."""
    return isinstance(item, TextInput | Heard) or (isinstance(item, TooLong) and item.asked)


def can_be_stopped(item: Item) -> bool:
    """Whether anything is said or done for it that a stop could end."""
    return not isinstance(item, _HOUSEKEEPING)


def way_of(item: Item) -> Way:
    """How this was asked for; what nobody asked for in particular has the way of words."""
    return item.way if isinstance(item, TextInput | Heard | RunSkill) else Way.TEXT_INPUT


def _bounded(item: Item) -> Item:
    """The same, unless it holds more words than are taken."""
    if not isinstance(item, TextInput | Heard | Speak) or len(item.text) <= MAX_CHARACTERS:
        return item
    beginning = clean(item.text)[:MAX_CHARACTERS]
    return TooLong(len(item.text), beginning, asked=not isinstance(item, Speak))
