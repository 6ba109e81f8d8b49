"""How people word programs in one language: the table `programs` of a phrasebook's file."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from edgevox.agent.phrase_numbers import NumberWords, Rewriting


@dataclass(frozen=True, slots=True)
class ProgramPhrases:
    """Sentence templates by kind, and what they need.

    A template is written as those of skills are: `[optional]`, `(one|or another)`, `{slot}` and
    `<rule>`. `rewrite` are patterns and what they become before that: "twice" is "2 times". Where
    words have no spaces between them, numbers count before `units` and after `ahead`; `words` are
    numbers that are said in no other place. `go` is the plain order to go to a place. `names` are
    words for a program when it is forgotten, by its kind. `me` are who wants to be told something:
    "tell me how full your battery is" asks for it, and is not to be said aloud.
    """

    templates: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    rules: Mapping[str, str] = field(default_factory=dict)
    rewrite: tuple[Rewriting, ...] = ()
    words: NumberWords | None = None
    units: str = ""
    ahead: str = ""
    go: str = ""
    between: tuple[str, ...] = ()
    me: tuple[str, ...] = ()
    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
