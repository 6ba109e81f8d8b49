"""What places, rooms and things may be called, in the files that describe them."""

import unicodedata

from edgevox.agent.name_rules import check_name
from edgevox.core.errors import InvalidValue

LONGEST_NAME = 64
"""In the file of a world, whose things are drawn more often than spoken of."""
LONGEST_PLACE = 40
"""Of a place that people name, in a file of theirs or by saying so."""


def read_name(where: str, value: object, longest: int = LONGEST_NAME) -> str:
    """A name that can be said, and that nobody needs for anything else.

    Raises `InvalidValue` with the name, and what would be right.
    """
    if not isinstance(value, str) or len(value) > longest or not speakable(value):
        raise InvalidValue(
            where,
            value,
            f"a name of at most {longest} letters, digits, spaces, _ and -, a letter first",
        )
    check_name(where, value)
    return value


def check_thing(where: str, name: object) -> str:
    """The name of a thing that is spoken of: another simulator's file may write it as it likes."""
    if not isinstance(name, str) or len(name) > LONGEST_NAME or not name.isprintable():
        raise InvalidValue(where, name, f"at most {LONGEST_NAME} characters that can be printed")
    check_name(where, name)
    return name


def speakable(name: str) -> bool:
    """Whether it is of letters, the marks that belong to them, digits and a little more."""
    kinds = [unicodedata.category(character)[0] for character in name]
    fits = all(kind in "LMN" or one in "_' -" for one, kind in zip(name, kinds, strict=True))
    return fits and kinds[:1] == ["L"]
