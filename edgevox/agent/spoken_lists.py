"""Long lists: spoken, a few and how many more there are; written, all."""

from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import TYPE_CHECKING

from edgevox.agent.spelling import key
from edgevox.core.reason import Reason

if TYPE_CHECKING:
    from edgevox.agent.phrasebook import Phrasebook

MOST_SPOKEN = 4
"""Lists up to this long are spoken whole; of a longer one all but one of so many are named."""


def brief(book: "Phrasebook", names: Sequence[str], said: str = "") -> str:
    """These words as they are spoken: of many only those nearest to what was said."""
    if len(names) <= MOST_SPOKEN:
        return book.listing(names)
    near = sorted(names, key=lambda name: -_nearness(book, name, said)) if said else names
    first = [str(book.word(name)) for name in near[: MOST_SPOKEN - 1]]
    spoken = book.say("separator").join(first)
    return book.say("more", first=spoken, count=len(names) - len(first))


def whole(book: "Phrasebook", names: Sequence[str]) -> str:
    """All of them, as a sentence of its own, if `brief` leaves some out."""
    return book.say("known", known=book.listing(names)) if len(names) > MOST_SPOKEN else ""


def detail(book: "Phrasebook", why: Reason) -> str:
    """What a reason leaves out where it is spoken: most of a long list, and names of topics."""
    lists = [value for value in why.values.values() if isinstance(value, tuple)]
    topic = book.say("topic", topic=why.values["topic"]) if "topic" in why.values else ""
    return " ".join(filter(None, (*(whole(book, names) for names in lists), topic)))


def _nearness(book: "Phrasebook", name: str, said: str) -> float:
    heard = (name, *book.word(name).heard)
    return max(SequenceMatcher(None, key(said), key(one)).ratio() for one in heard)
