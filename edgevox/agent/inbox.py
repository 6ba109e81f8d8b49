"""What waits for the conversation's thread: no more than so many, each of a bounded length."""

from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass

from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.refusals import Refusal
from edgevox.core.text import MAX_CHARACTERS, clean
from edgevox.core.ways import Way

MAX_WAITING = 64
"""How many utterances may wait. One more is refused; a stop never is."""
LIMITS: Mapping[Refusal, int] = {
    Refusal.TOO_LONG: MAX_CHARACTERS,
    Refusal.TOO_MANY: MAX_WAITING,
}
"""Why something that is asked may not be taken, and how much is."""


@dataclass(frozen=True, slots=True)
class Announce:
    """Something to say that nobody asked for now: a goal ended, the robot stopped."""

    text: str


@dataclass(frozen=True, slots=True)
class Forget:
    """Forget what was said, between turns."""


@dataclass(frozen=True, slots=True)
class Settle:
    """Say that the conversation listens again, after a stop that cut no turn."""


@dataclass(frozen=True, slots=True)
class Language:
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


Item = TextInput | Heard | Speak | RunSkill | TooLong | Announce | Forget | Settle | Language

_ASKED = TextInput | Heard | Speak | RunSkill


class Inbox:
    """A queue in the order of asking. Not thread-safe; who owns it locks."""

    def __init__(self) -> None:
        self._items: deque[Item] = deque()
        self.refusals = Counter({str(reason): 0 for reason in LIMITS})

    def __bool__(self) -> bool:
        return bool(self._items)

    def put(self, item: Item) -> Refusal | None:
        """Let it wait; else why not, which is counted.

        What is too long is told so in its turn.
        """
        if isinstance(item, _ASKED) and len(self._items) >= MAX_WAITING:
            return self._refuse(Refusal.TOO_MANY)
        last = self._items[-1] if self._items else None
        if isinstance(item, Language | Forget) and type(last) is type(item):
            self._items.pop()  # of two on end only the last one counts
        self._items.append(_bounded(item))
        return self._refuse(Refusal.TOO_LONG) if isinstance(self._items[-1], TooLong) else None

    def take(self) -> Item:
        """The next one."""
        return self._items.popleft()

    def stop(self) -> None:
        """Forget all that is to be said and done; who is forgotten and what is spoken stays."""
        last = {type(one): one for one in self._items if isinstance(one, Language | Forget)}
        self._items = deque(last.values())

    def clear(self) -> None:
        """Forget everything."""
        self._items.clear()

    def _refuse(self, reason: Refusal) -> Refusal:
        self.refusals[reason] += 1
        return reason


def asked_in_words(item: Item) -> bool:
    """Whether somebody wants an answer to this."""
    return isinstance(item, TextInput | Heard) or (isinstance(item, TooLong) and item.asked)


def way_of(item: Item) -> Way:
    """How this was asked for; what nobody asked for in particular has the way of words."""
    return item.way if isinstance(item, TextInput | Heard | RunSkill) else Way.TEXT_INPUT


def _bounded(item: Item) -> Item:
    """The same, unless it holds more words than are taken."""
    if not isinstance(item, TextInput | Heard | Speak) or len(item.text) <= MAX_CHARACTERS:
        return item
    beginning = clean(item.text)[:MAX_CHARACTERS]
    return TooLong(len(item.text), beginning, asked=not isinstance(item, Speak))
