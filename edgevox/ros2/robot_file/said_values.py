"""Values that a skill of a robot file speaks of, and the words for them, in each language."""

from collections.abc import Iterator, Mapping
from string import Formatter

from edgevox.core.validation import Place
from edgevox.core.yaml_file import YamlFile, value_key
from edgevox.ros2.robot_file.interfaces import is_primitive, is_text
from edgevox.ros2.robot_file.robot_file_format import Sentences, SkillEntry

_TRUTH, _NUMBER, _TEXT = "boolean", "number", "text"
_TRUTHS = ("true", "false")
_FORMATTED = ("says", "asks", "done")


def every_language(entry: SkillEntry, at: Place) -> Iterator[tuple[Place, Sentences]]:
    """What is said of a skill that stands `at` this place, English first, each with its place."""
    yield at, entry
    for code, said in entry.languages.items():
        yield (*at, "languages", code), said


def values_in(text: str) -> set[str]:
    """The values that a sentence says, as it names them. Raises `ValueError` for lone braces."""
    parts = [part for part in Formatter().parse(text) if part[1] is not None]
    for _, name, how, conversion in parts:
        if how or conversion:
            raise ValueError(f"{{{name}}} is written out as it is")
    return {str(name) for _, name, *_ in parts}


def check_words(entry: SkillEntry, results: Mapping[str, str], file: YamlFile, at: Place) -> None:
    """Raise `InvalidValue` for words of no value, and for a truth that is said without words.

    `results` are the types of all results, by their names.
    """
    kinds = _kinds(entry, results)
    for place, said in every_language(entry, at):
        for name, words in said.words.items():
            where = (*place, "words", name)
            if name not in kinds:
                expected = "a result or an argument that is no choice: one of "
                raise file.wrong(where, name, expected + (", ".join(kinds) or "none"))
            for value in words:
                if expected := _unlike(kinds[name], value):
                    raise file.wrong((*where, value), value, expected)
        for key in _FORMATTED:
            for name in sorted(values_in(getattr(said, key))):
                if kinds.get(name) == _TRUTH and set(_TRUTHS) - said.words.get(name, {}).keys():
                    expected = f'words for it: words: {{{name}: {{"true": ..., "false": ...}}}}'
                    raise file.wrong((*place, key), name, expected)


def _kinds(entry: SkillEntry, results: Mapping[str, str]) -> dict[str, str]:
    """The values that may have words here; those of a choice have `names`."""
    asked = {name: one.type for name, one in entry.arguments.items() if one.type != "choice"}
    kinds = {"boolean": _TRUTH, "text": _TEXT}
    told = {name: _kind(type_name) for name, type_name in results.items()}
    return {name: kinds.get(one, _NUMBER) for name, one in asked.items()} | {
        name: one for name, one in told.items() if one
    }


def _kind(type_name: str) -> str:
    if not is_primitive(type_name):
        return ""
    return _TEXT if is_text(type_name) else _TRUTH if type_name == "boolean" else _NUMBER


def _unlike(kind: str, value: str) -> str:
    """What a value of this kind is written as instead; empty if it may be written so."""
    if kind == _TRUTH:
        return "" if value in _TRUTHS else "true or false"
    if kind == _TEXT:
        return ""
    try:
        written = value_key(float(value))
    except (ValueError, OverflowError):
        return "a number"
    return "" if written == value else f"{written}, as the number is said"
