"""Names of places, rooms and things, in the files that describe them.

The key `names` has the names of a room, place or choice by language:

    pharmacy:
      names:
        de: die Apotheke
        fr: [la pharmacie, l'officine]
        ru: {name: аптека, to: в аптеку, at: в аптеке, heard: [аптеку, аптечный пункт]}

The robot says the first name of a language, and understands all of them while it is spoken.
"""

import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from edgevox.agent.phrases.name_rules import bare_name, check_name, is_clause_word, name_clash
from edgevox.agent.skills.skill import OwnName
from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import Place, wrong
from edgevox.core.languages import LANGUAGES

LONGEST_NAME = 64
"""The longest name in the file of a world, whose things are drawn more often than spoken of."""
LONGEST_PLACE = 40
"""The longest name of a place that people give, in their file or by voice."""


def read_name(where: str, value: object, longest: int = LONGEST_NAME) -> str:
    """Read a name that can be spoken, and that has no other meaning.

    Raises `InvalidValue` with the name and the expected value.
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
    """Return whether the name has only letters, their marks, digits, spaces and `_'-`."""
    kinds = [unicodedata.category(character)[0] for character in name]
    fits = all(kind in "LMN" or one in "_' -" for one, kind in zip(name, kinds, strict=True))
    return fits and kinds[:1] == ["L"]


_FORMS = ("to", "at", "taken")
_KEYS = ("name", "heard", *_FORMS)
_LONGEST_FORM = 80

NamesByCode = Mapping[str, OwnName]


def _read(data: Any) -> NamesByCode:
    if not isinstance(data, Mapping):
        raise ValueError("a mapping, the code of a language to names")  # noqa: TRY004 - of pydantic's kind
    return {code: _of_language(code, given) for code, given in data.items()}


_TEXT: dict[str, Any] = {"type": "string", "maxLength": LONGEST_PLACE}
_SEVERAL: dict[str, Any] = {"type": "array", "items": _TEXT, "minItems": 1}
_WRITTEN: dict[str, Any] = {
    "type": "object",
    "required": ["name"],
    "properties": {"name": _TEXT, "heard": {"type": "array", "items": _TEXT}}
    | {one: {"type": "string", "maxLength": _LONGEST_FORM} for one in _FORMS},
    "additionalProperties": False,
}
_SCHEMA: dict[str, Any] = {
    "type": "object",
    "propertyNames": {"enum": sorted(LANGUAGES)},
    "additionalProperties": {"anyOf": [_TEXT, _SEVERAL, _WRITTEN]},
}

LocalNames = Annotated[NamesByCode, BeforeValidator(_read), WithJsonSchema(_SCHEMA)]
"""The field `names` of whatever has a name."""


def _only_said(data: Any) -> Mapping[str, str]:
    names = _read(data)
    for code, one in names.items():
        if one != OwnName(one.name):
            raise wrong((code,), one.name, "one name: a thing is mentioned, never asked for")
    return {code: one.name for code, one in names.items()}


MentionedNames = Annotated[Mapping[str, str], BeforeValidator(_only_said)]
"""The field `names` of what is only spoken of: one name a language."""


def check_told_apart(
    entries: Mapping[str, tuple[Iterable[str], NamesByCode]],
    place: Callable[[str, str], Place] = lambda word, code: (word, "names", code),
) -> None:
    """Raise what a validator raises where two of these are called the same, by `same_name`.

    `entries` are the aliases and the names of words; `place` is where the names of one are.
    """
    if clash := name_clash(entries):
        word, code, said, other = clash
        at = place(word, code) if code else (word,)
        raise wrong(at, said, f"a name that {other!r} does not have")


def _of_language(code: Any, given: Any) -> OwnName:
    if code not in LANGUAGES:
        raise wrong((str(code),), code, "a language: " + ", ".join(LANGUAGES))
    forms: Mapping[str, Any] = given if isinstance(given, Mapping) else {}
    for one in forms:
        if one not in _KEYS:
            raise wrong((code, str(one)), one, "one of " + ", ".join(_KEYS))
    names = [_name(code, place, name) for place, name in _listed(code, given)]
    if not names:
        raise wrong((code,), given, "at least one name")
    first, *others = names
    return OwnName(first, tuple(others), **{one: _form(code, forms, one) for one in _FORMS})


def _listed(code: str, given: Any) -> Iterator[tuple[Place, Any]]:
    """The names with their places, the one that is said first."""
    if isinstance(given, Mapping):
        yield (code, "name"), given.get("name")
        yield from _items((code, "heard"), given.get("heard", []))
    elif isinstance(given, list):
        yield from _items((code,), given)
    else:
        yield (code,), given


def _items(place: Place, given: Any) -> Iterator[tuple[Place, Any]]:
    if not isinstance(given, list):
        raise wrong(place, given, "a list of names")
    yield from (((*place, index), name) for index, name in enumerate(given))


def _name(code: str, place: Place, name: Any) -> str:
    """Return the name as written; its form without the article must be free as well."""
    try:
        read_name("", name, LONGEST_PLACE)
        bare = read_name("", bare_name(code, name), LONGEST_PLACE)
    except InvalidValue as error:
        raise wrong(place, name, error.expected) from None
    if is_clause_word(bare, (code,)):
        raise wrong(place, name, f"another name: {bare!r} stands for something else")
    return str(name)


def _form(code: str, forms: Mapping[str, Any], one: str) -> str:
    text = forms.get(one, "")
    if not isinstance(text, str) or len(text) > _LONGEST_FORM or not f"x{text}".isprintable():
        expected = f"a text of at most {_LONGEST_FORM} characters, as it stands in a sentence"
        raise wrong((code, one), text, expected)
    return text
