"""The conversation's queue: a bounded number of items, each of a bounded length."""

import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, replace

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput, Way
from edgevox.core.errors import Refusal
from edgevox.core.files.text import MAX_CHARACTERS, clean
from edgevox.core.log import get_logger

log = get_logger(__name__)

MAX_WAITING = 64
"""Number of requests that may wait. One more is refused; a stop never is."""
LIMITS: Mapping[Refusal, int] = {
    Refusal.TOO_LONG: MAX_CHARACTERS,
    Refusal.TOO_MANY: MAX_WAITING,
}
"""The reasons to refuse a request, each with its limit (characters, requests)."""


@dataclass(frozen=True, slots=True)
class Announce:
    """A sentence that no turn asked for: a goal ended, the robot stopped."""

    text: str
    """The sentence to say."""
    detail: str = ""
    """Text that is written beside the sentence and not spoken."""


@dataclass(frozen=True, slots=True)
class Forget:
    """Forget the conversation so far, between turns."""


@dataclass(frozen=True, slots=True)
class CountedDown:
    """The time of a countdown is over."""

    way: Way
    """The way in which its words came."""


@dataclass(frozen=True, slots=True)
class Settle:
    """Return to the state `listening`, after a stop that cut no turn."""


@dataclass(frozen=True, slots=True)
class SwitchLanguage:
    """Switch to another language, between turns."""

    code: str
    """ISO 639-1 code."""


@dataclass(frozen=True, slots=True)
class TooLong:
    """Replaces a text that is longer than `MAX_CHARACTERS`."""

    length: int
    """Number of characters of the whole text."""
    beginning: str
    """The first `MAX_CHARACTERS` characters."""
    asked: bool
    """True if the text was for the agent, False if it was to be said aloud."""


@dataclass(frozen=True, slots=True)
class Stopped:
    """The robot stopped for words that say more than a stop word: "wait, the office"."""

    told: str
    """The sentence to say about the stop; empty if it stood, or if that was told already."""
    words: TextInput | Heard
    """What was said."""
    stood: str
    """The words before the stop word, said to a robot that stood; else empty."""
    opened: str
    """All of the words, if they stopped it only because a wait opens them; else empty."""
    before: str
    """The words before the stop word."""
    after: str
    """The words after it."""


Item = (TextInput | Heard | Speak | RunSkill | TooLong | Announce | Stopped | Forget | Settle) | (
    SwitchLanguage | CountedDown
)


@dataclass(frozen=True, slots=True)
class _Waiting:
    """An item in the queue."""

    item: Item
    put_s: float
    """The clock's time when the item was put."""
    mark: int
    """The interlock's mark when the item was asked for."""


_ASKED = TextInput | Heard | Speak | RunSkill
_HOUSEKEEPING = Forget | Settle | SwitchLanguage


class Inbox:
    """A first-in, first-out queue: any thread puts; one thread takes, and works until `done`."""

    def __init__(self, clock: Clock | None = None) -> None:
        self.gate = threading.Condition()
        """Held while the queue changes; hold it to do something together with a change."""
        self.since_s = 0.0
        """The clock's time when the item that was taken last had been put."""
        self.mark = 0
        """The interlock's mark when the item that was taken last was asked for."""
        self._clock = clock or SystemClock()
        self._items: deque[_Waiting] = deque()
        self._at_work = False
        self._closed = False
        self.refusals = Counter({str(reason): 0 for reason in LIMITS})

    @property
    def closed(self) -> bool:
        """True once `close` was called: the inbox takes nothing any more."""
        return self._closed

    @property
    def idle(self) -> bool:
        """True if no item waits and the taking thread is not at work."""
        with self.gate:
            return not (self._items or self._at_work)

    def put(self, item: Item, mark: int = 0) -> Refusal | None:
        """Queue the item and return None, or return why not; a refusal is counted and logged.

        A text that is too long is queued as `TooLong`, so that its turn tells the person.
        """
        with self.gate:
            refusal = None if self._closed else self._put(item, mark)
            self.gate.notify_all()
        if refusal:
            log.warning("request_refused", reason=refusal, limit=LIMITS[refusal])
        return refusal

    def announce(self, text: str, detail: str = "") -> None:
        """Queue a sentence that no turn asked for, and `detail` to be written beside it."""
        self.put(Announce(text, detail))

    def take(self, timeout_s: float | None = None) -> Item | None:
        """Wait for the next item and take it; None once closed, and after the timeout.

        The caller counts as at work until it calls `done`.
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
        """Tell that the work on the taken item is finished."""
        with self.gate:
            self._at_work = False
            self.gate.notify_all()

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until the inbox is `idle`; False after the timeout."""
        with self.gate:
            return self.gate.wait_for(lambda: self.idle, timeout_s)

    def withdraw(self, ended_s: float) -> None:
        """Forget the utterance that ended at `ended_s`, if it still waits."""
        with self.gate:
            gone = [one for one in self._items if getattr(one.item, "ended_s", None) == ended_s]
            for one in gone:
                self._items.remove(one)

    def stop(self) -> None:
        """Forget everything that is to be said or done; keep `SwitchLanguage` and `Forget`."""
        with self.gate:
            kept = [one for one in self._items if isinstance(one.item, SwitchLanguage | Forget)]
            self._items = deque({type(one.item): one for one in kept}.values())

    def remark(self, mark: int) -> None:
        """Give this mark to every waiting item, so that the stop in the current turn spares it."""
        with self.gate:
            self._items = deque(replace(one, mark=mark) for one in self._items)

    def close(self) -> None:
        """Forget everything, and take nothing from now on."""
        with self.gate:
            self._closed = True
            self._items.clear()
            self.gate.notify_all()

    def _put(self, item: Item, mark: int) -> Refusal | None:
        if isinstance(item, _ASKED) and len(self._items) >= MAX_WAITING:
            return self._refuse(Refusal.TOO_MANY)
        last = self._items[-1].item if self._items else None
        if isinstance(item, _HOUSEKEEPING) and type(last) is type(item):
            self._items.pop()  # of two in a row only the last one counts
        bounded = _bounded(item)
        self._items.append(_Waiting(bounded, self._clock.now(), mark))
        return self._refuse(Refusal.TOO_LONG) if isinstance(bounded, TooLong) else None

    def _refuse(self, reason: Refusal) -> Refusal:
        self.refusals[reason] += 1
        return reason


def asked_in_words(item: Item) -> bool:
    """True if the item is words for the agent, which want an answer."""
    words = isinstance(item, TextInput | Heard | Stopped)
    return words or (isinstance(item, TooLong) and item.asked)


def can_be_stopped(item: Item) -> bool:
    """True if the item makes the robot say or do something that a stop could end."""
    return not isinstance(item, _HOUSEKEEPING)


def words_of(item: Item | None) -> Item | None:
    """The item, or the words that the robot stopped for."""
    return item.words if isinstance(item, Stopped) else item


def way_of(item: Item) -> Way:
    """The way in which the item was asked for; `TEXT_INPUT` for one that has no way."""
    return (
        item.way if isinstance(item, TextInput | Heard | RunSkill | CountedDown) else Way.TEXT_INPUT
    )


def _bounded(item: Item) -> Item:
    """The item itself, or `TooLong` if its text is longer than `MAX_CHARACTERS`."""
    if not isinstance(item, TextInput | Heard | Speak) or len(item.text) <= MAX_CHARACTERS:
        return item
    beginning = clean(item.text)[:MAX_CHARACTERS]
    return TooLong(len(item.text), beginning, asked=not isinstance(item, Speak))
