"""What waits for the conversation's thread: no more than so many, each of a bounded length."""

from collections import Counter, deque
from collections.abc import Mapping

from edgevox.agent.items import Forget, Item, Language, TooLong, bounded
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.refusals import Refusal
from edgevox.core.text import MAX_CHARACTERS

MAX_WAITING = 64
"""How many utterances may wait. One more is refused; a stop never is."""
LIMITS: Mapping[Refusal, int] = {
    Refusal.TOO_LONG: MAX_CHARACTERS,
    Refusal.TOO_MANY: MAX_WAITING,
}
"""Why something that is asked may not be taken, and how much is."""

_ASKED = TextInput | Heard | Speak | RunSkill


class Waiting:
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
        self._items.append(bounded(item))
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
