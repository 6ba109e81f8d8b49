"""Annotations of a skill's arguments: one of some words, or a new name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from pydantic_core import PydanticKnownError, core_schema

from edgevox.agent.text.same_name import name_form

MOST_HINTS = 6
"""Number of an argument's words that a language model sees in examples."""


@dataclass(frozen=True, slots=True)
class OwnName:
    """The name of a word in one language, from a file or a skill: "die Apotheke".

    `name` may begin with an article, by which the forms of going there (`to`), of being there
    (`at`) and of grasping it (`taken`) are found, unless they are given. `heard` are other things
    people say for it.
    """

    name: str
    heard: tuple[str, ...] = ()
    to: str = ""
    at: str = ""
    taken: str = ""


OwnNames = Mapping[str, Mapping[str, OwnName]]
"""By word, and then by the code of the language."""


@dataclass(frozen=True, slots=True)
class OneOf:
    """Annotates a string argument that takes one of some words.

    Words match by the form of a name: see `same_name`.
    """

    fixed: tuple[str, ...]
    """The words that never change."""
    aliases: Mapping[str, str] = field(default_factory=dict)
    """Other names for a word, in every language: "fridge" for "kitchen"."""
    learned: Callable[[], tuple[str, ...]] = tuple
    """Returns the words learned at run time. Must be quick; any thread may call it."""
    names: OwnNames = field(default_factory=dict)
    """Names of a word by language, said and understood while that language is spoken."""

    @property
    def words(self) -> tuple[str, ...]:
        """All words now, fixed and learned."""
        return (*self.fixed, *self.learned())

    def spoken(self) -> dict[str, str]:
        """Everything that may be said for a word, in lower case and with spaces, to that word."""
        return {_plain(said): word for said, word in self.aliases.items()} | {
            _plain(word): word for word in self.words
        }

    def _pick(self, value: Any) -> str:
        spoken = self.spoken()
        word = spoken.get(_plain(value)) if isinstance(value, str) else None
        if word is None and isinstance(value, str):
            form = name_form(value)
            same = {meant for said, meant in spoken.items() if name_form(said) == form}
            word = same.pop() if len(same) == 1 else None
        if word is None:
            *others, last = [repr(one) for one in self.words] or ["a word that was learned before"]
            expected = f"{', '.join(others)} or {last}" if others else last
            raise PydanticKnownError("literal_error", {"expected": expected})
        return word

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_plain_validator_function(self._pick)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"type": "string", "enum": list(self.words)}


@dataclass(frozen=True, slots=True)
class NewName:
    """Annotates a string argument that is a new name: "call this the dock".

    A sentence gives it without its article; the `places` of a phrasebook are usual ones.
    """


@lru_cache(maxsize=4096)
def _plain(word: str) -> str:
    text = word.casefold().replace("_", " ").strip()
    return " ".join(text.removeprefix("the ").split())
