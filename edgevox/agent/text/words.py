"""Words in the forms that sentences need: a thing's name, and how one speaks of it.

Forms of words and sentences that phrasebooks need, whatever the language.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from string import Formatter
from typing import Any

from edgevox.core.files.yaml_file import value_key
from edgevox.core.reason import Named

_ONE_NAME = {"location": "room"}
"""Names of arguments that phrasebooks replace: all places are rooms to them."""


def bare(sentence: str) -> str:
    """Without the full stop: it becomes part of another sentence."""
    return sentence.rstrip(". \u3002\u0964")


def as_sentence(text: str) -> str:
    """Words as a sentence of their own; empty if there are none."""
    said = " ".join(text.split())
    return said if not said or said[-1] in ".!?\u3002\u0964" else f"{said[:1].upper()}{said[1:]}."


def as_part(sentence: str) -> str:
    """A sentence as a part of another."""
    return continued(sentence).rstrip(".")


def continued(sentence: str) -> str:
    """A sentence as the end of another; the English "I" stays."""
    if re.match(r"I\b", sentence):
        return sentence
    return f"{sentence[:1].lower()}{sentence[1:]}"


def in_english(value: Any) -> Any:
    """A value as English sentences use it."""
    return value.replace("_", " ") if isinstance(value, str) else value


def fields(template: str) -> set[str]:
    """The values that a sentence needs, without their forms: "{room.to}" needs "room"."""
    names = (name for _, name, _, _ in Formatter().parse(template) if name)
    return {re.split(r"[.\[]", name)[0] for name in names}


def spoken_name(argument: str) -> str:
    """The name of an argument or a result in phrasebooks."""
    return _ONE_NAME.get(argument, argument)


_NO_WORD = {"name": "{name}"}


@dataclass(frozen=True, slots=True)
class Word:
    """A word for an argument or a result, in the forms that sentences need."""

    name: str
    """The word with its article."""
    to: str
    """The form with the preposition of going there."""
    at: str
    """The form with the preposition of being there."""
    taken: str
    """The form as the object of grasping."""
    heard: tuple[str, ...] = ()
    """Other words that people say for it."""
    hints: tuple[str, ...] = ()
    """Sentences that mean the word without naming it."""

    def __str__(self) -> str:
        return self.name

    def called(self, name: str) -> "Word":
        """The word's forms with another name."""
        forms = (self.name, self.to, self.at, self.taken)
        named, to, at, taken = (form.replace("{name}", name) for form in forms)
        return Word(named, to, at, taken, heard=(name,))


def word_of(data: Mapping[str, Any] | None) -> Word:
    """A word of a phrasebook's file; without data, the forms of an unknown word."""
    data = data or _NO_WORD
    name = data["name"]
    return Word(
        name=name,
        to=data.get("to", name),
        at=data.get("at", name),
        taken=data.get("taken", name),
        heard=tuple(data.get("heard", (name,))),
        hints=tuple(data.get("hints", ())),
    )


OTHER = "other"
"""The key of what is said for every value without words of its own; it may name the value."""


class SpokenNumber(float):
    """A number as people say it, 2 and not 2.0, however many decimals its sentence has."""

    def __format__(self, spec: str) -> str:
        said = super().__format__(spec) if spec else repr(self)  # without a spec it calls `__str__`
        if "." in said and said.lstrip("-").replace(".", "").isdigit():
            said = said.rstrip("0").rstrip(".")
        return "0" if said == "-0" else said

    def __str__(self) -> str:
        return format(self, "")


def as_said(value: Any) -> Any:
    """A number as people say it; others as they are."""
    return SpokenNumber(value) if isinstance(value, float) else value


def worded(values: Mapping[str, Any], words: Mapping[str, Mapping[str, str]]) -> Mapping[str, Any]:
    """Values as sentences need them: what is said for one, where there is something."""
    said = {name: _word_for(words.get(name, {}), name, value) for name, value in values.items()}
    return {**values, **{name: _PLAIN.called(text) for name, text in said.items() if text}}


def _word_for(words: Mapping[str, str], name: str, value: Any) -> str:
    if not words:
        return ""
    other = words.get(OTHER, "") if value is not None else ""
    return words.get(value_key(value)) or other.replace(f"{{{name}}}", value_key(value))


def in_brackets(values: Iterable[Any], code: str) -> str:
    """The names in a language of those that have one there, behind a sentence without them."""
    names = (one.names.get(code) for one in values if isinstance(one, Named))
    return "".join(f" ({name})" for name in names if name)


_PLAIN = word_of(None)
