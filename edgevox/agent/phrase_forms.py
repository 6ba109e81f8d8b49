"""Forms of words and sentences that phrasebooks need, whatever the language."""

import re
from string import Formatter
from typing import Any

_ONE_NAME = {"location": "room"}
"""What phrasebooks call by another name: all places are spoken of as rooms."""


def bare(sentence: str) -> str:
    """Without the full stop: it becomes part of another sentence."""
    return sentence.rstrip(". \u3002\u0964")


def as_part(sentence: str) -> str:
    """A sentence as a part of another."""
    return continued(sentence).rstrip(".")


def continued(sentence: str) -> str:
    """A sentence as the end of another."""
    return f"{sentence[:1].lower()}{sentence[1:]}"


def in_english(value: Any) -> Any:
    """A value as English sentences use it."""
    return value.replace("_", " ") if isinstance(value, str) else value


def fields(template: str) -> set[str]:
    """The values that a sentence needs, without their forms: "{room.to}" needs "room"."""
    names = (name for _, name, _, _ in Formatter().parse(template) if name)
    return {re.split(r"[.\[]", name)[0] for name in names}


def spoken_name(argument: str) -> str:
    """How phrasebooks call an argument or a result of this name."""
    return _ONE_NAME.get(argument, argument)
