"""What waits for the conversation's thread: bounded, whatever comes from outside."""

from collections import deque

from edgevox.agent.items import Forget, Item, Language
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput

MAX_WAITING = 64
"""How many utterances may wait. One more is refused; a stop never is."""
MAX_CHARACTERS = 1_000_000
"""How much text may wait in all of them."""

_ASKED = TextInput | Heard | Speak | RunSkill


class Waiting:
    """A queue in the order of asking. Not thread-safe; who owns it locks."""

    def __init__(self) -> None:
        self._items: deque[Item] = deque()

    def __bool__(self) -> bool:
        return bool(self._items)

    def put(self, item: Item) -> bool:
        """Let it wait; False if it was asked for and there is no room."""
        if isinstance(item, _ASKED) and self._full(item):
            return False
        last = self._items[-1] if self._items else None
        if isinstance(item, Language | Forget) and type(last) is type(item):
            self._items.pop()  # of two on end only the last one counts
        self._items.append(item)
        return True

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

    def _full(self, item: Item) -> bool:
        if len(self._items) >= MAX_WAITING:
            return True
        return sum(map(_characters, self._items)) + _characters(item) > MAX_CHARACTERS


def _characters(item: Item) -> int:
    return len(item.text) if isinstance(item, TextInput | Heard | Speak) else 0
