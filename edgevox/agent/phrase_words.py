"""Words in the forms that sentences need: a thing's name, and how one speaks of it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from edgevox.core.reason import Named
from edgevox.core.yaml_file import value_key

_NO_WORD = {"name": "{name}"}


@dataclass(frozen=True, slots=True)
class Word:
    """A word that an argument or a result may be, in the forms that sentences need.

    `name` with its article, `to` and `at` with the prepositions of going and of being there,
    `taken` as what somebody grasps. `heard` is what people say for it, `hints` are sentences of
    people who mean it without saying it.
    """

    name: str
    to: str
    at: str
    taken: str
    heard: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.name

    def called(self, name: str) -> "Word":
        """The same forms, of another name."""
        forms = (self.name, self.to, self.at, self.taken)
        named, to, at, taken = (form.replace("{name}", name) for form in forms)
        return Word(named, to, at, taken, heard=(name,))


def word_of(data: Mapping[str, Any] | None) -> Word:
    """A word of a phrasebook's file; without one the forms of a word that nobody knows."""
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


def worded(values: Mapping[str, Any], words: Mapping[str, Mapping[str, str]]) -> Mapping[str, Any]:
    """Values as sentences need them: what is said for one, where there is something."""
    said = {name: words.get(name, {}).get(value_key(value)) for name, value in values.items()}
    return {**values, **{name: _PLAIN.called(text) for name, text in said.items() if text}}


def in_brackets(values: Iterable[Any], code: str) -> str:
    """The names in a language of those that have one there, behind a sentence without them."""
    names = (one.names.get(code) for one in values if isinstance(one, Named))
    return "".join(f" ({name})" for name in names if name)


_PLAIN = word_of(None)
