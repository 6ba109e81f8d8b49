"""The arguments of a skill in the file: their model, their meanings in a request, and samples.

Also here: the words for a skill's values, in each language.
"""

from collections.abc import Iterator, Mapping
from string import Formatter
from types import MappingProxyType
from typing import Annotated, Any, Protocol

from pydantic import BaseModel, ConfigDict, Field, create_model

from edgevox.agent.skills import OneOf
from edgevox.agent.text.words import OTHER, bare
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile, value_key
from edgevox.core.reason import Named, Reason, in_english
from edgevox.ros2.robot_file.format import Argument, Sentences, SkillEntry
from edgevox.ros2.robot_file.messages import converted, is_primitive, is_text
from edgevox.ros2.robot_file.steps import Meaning

_TRUTH, _NUMBER, _TEXT = "boolean", "number", "text"
_TRUTHS = ("true", "false")
_FORMATTED = ("says", "asks", "done", "failed")


def every_language(entry: SkillEntry) -> Iterator[Sentences]:
    """Yield the sentences of a skill, English first."""
    yield from (entry, *entry.languages.values())


def every_language_at(entry: SkillEntry, at: Place) -> Iterator[tuple[Place, Sentences]]:
    """Yield the sentences of the skill `at` this place, English first, each with its place."""
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


class Known(Protocol):
    """What is known of the results of a skill."""

    results: dict[str, str]
    """Their types, by their names."""
    constants: dict[str, Mapping[str, Any]]
    """The constants of their messages, by the results' names."""


Constants = Mapping[str, Mapping[str, Any]]
"""The constants by which the file may call the values of results, by the results' names."""
NO_CONSTANTS: Constants = MappingProxyType({})


def by_value(
    words: Mapping[str, Mapping[str, str]], constants: Constants
) -> Mapping[str, Mapping[str, str]]:
    """The words, with the values of constants instead of their names."""

    def value(name: str, key: str) -> str:
        known = constants.get(name, {})
        return value_key(known[key]) if key in known else key

    return {
        name: {value(name, key): said for key, said in by_value.items()}
        for name, by_value in words.items()
    }


def check_words(
    entry: SkillEntry, known: Known, file: YamlFile, at: Place, problems: Problems
) -> None:
    """Find words of no value, and a truth that is said without words."""
    kinds = _kinds(entry, known.results)
    for place, said in every_language_at(entry, at):
        for name, words in said.words.items():
            where = (*place, "words", name)
            if name not in kinds:
                if known.results.get(name) != "":
                    expected = "a result or an argument that is no choice: one of "
                    wrong = file.wrong(where, name, expected + (", ".join(kinds) or "none"))
                    problems.found.append(wrong)
                continue
            for value in words:
                constants = known.constants.get(name, {})
                if value in (OTHER, *constants):
                    continue
                if expected := _unlike(kinds[name], value):
                    expected += ", or a constant: " * bool(constants) + ", ".join(constants)
                    problems.found.append(file.wrong((*where, value), value, expected))
        for key in _FORMATTED:
            with problems.collect():
                _check_truths(said, key, kinds, file, (*place, key))


def _check_truths(
    said: Sentences, key: str, kinds: Mapping[str, str], file: YamlFile, at: Place
) -> None:
    try:
        names = sorted(values_in(getattr(said, key)))
    except ValueError:  # told elsewhere
        return
    for name in names:
        words = said.words.get(name, {}).keys()
        if kinds.get(name) == _TRUTH and OTHER not in words and set(_TRUTHS) - words:
            expected = f'words for it: words: {{{name}: {{"true": ..., "false": ...}}}}'
            raise file.wrong(at, name, expected)


REASON = "reason"
"""What a sentence about a failure calls its usual reason."""


def failure_of(
    entry: SkillEntry, found: Reason, values: Mapping[str, Any], constants: Constants = NO_CONSTANTS
) -> Reason:
    """Return a failure in the file's words, in each language in which it has some.

    `values` are all that are known: a sentence that names another is not said.
    """
    told = {
        code: said.failed
        for code, said in {"en": entry, **entry.languages}.items()
        if said.failed and _all_known(said.failed, values)
    }
    if "en" not in told:
        return found
    named = set().union(*map(values_in, told.values()))
    about: dict[str, Reason | Named | str | tuple[str, ...]] = {}
    for name in named - {REASON}:
        about[name] = _about(entry, name, values[name], constants)
    if REASON in named:
        about[REASON] = found
    english = {name: in_english(value) for name, value in about.items()}
    text = told["en"].format(**english)
    return Reason(text, found.code, about, told, is_sentence=True)


def _all_known(sentence: str, values: Mapping[str, Any]) -> bool:
    return all(
        name == REASON or values.get(name) not in (None, "", []) for name in values_in(sentence)
    )


def _about(
    entry: SkillEntry, name: str, value: Any, constants: Constants
) -> Named | str | tuple[str, ...]:
    """A value as reasons have it, with its words in each language."""
    said = {"en": entry, **entry.languages}
    words = {
        code: _word(by_value(one.words, constants).get(name, {}), value)
        for code, one in said.items()
    }
    if any(words.values()):
        return Named(value_key(value), {code: one for code, one in words.items() if one})
    if isinstance(value, list):
        return tuple(map(value_key, value))
    return bare(value_key(value))


def _word(words: Mapping[str, str], value: Any) -> str:
    return words.get(value_key(value)) or words.get(OTHER, "")


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
    """Return the form in which such a value must be written; empty if it is right."""
    if kind == _TRUTH:
        return "" if value in _TRUTHS else "true or false"
    if kind == _TEXT:
        return ""
    try:
        written = value_key(float(value))
    except (ValueError, OverflowError):
        return "a number"
    return "" if written == value else f"{written}, as the number is said"


LONGEST_TEXT = 500
_TYPES: Mapping[str, type] = {"number": float, "integer": int, "boolean": bool, "text": str}
_FAR = 2**53


def arguments_model(name: str, arguments: Mapping[str, Argument]) -> type[BaseModel]:
    """The model that a call's arguments are held to."""
    fields: dict[str, Any] = {
        key: (_annotated(one), ... if one.default is None else one.default)
        for key, one in arguments.items()
    }
    config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
    return create_model(f"{name}_arguments", __config__=config, **fields)


def meanings(arguments: Mapping[str, Argument], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the request's values.

    A choice's word replaced by its meaning, other values as they are.
    """
    return {name: _meaning(arguments[name], value) for name, value in values.items()}


def samples(arguments: Mapping[str, Argument]) -> Iterator[tuple[str, dict[str, Meaning]]]:
    """Values that a request has to take, and the argument that is tried with each: its extremes."""
    every = {
        name: [_meaning(one, value) for value in _samples(one)] for name, one in arguments.items()
    }
    usual = {name: values[0] for name, values in every.items()}
    yield "", usual
    for name, values in every.items():
        yield from ((name, {**usual, name: value}) for value in values)


def _annotated(one: Argument) -> Any:
    about = f"{one.description} ({one.unit})" if one.unit else one.description
    if one.type == "choice":
        words = OneOf(tuple(one.meanings), one.aliases, names=one.names)
        return Annotated[str, words, Field(description=about)]
    bounds: dict[str, Any] = {"ge": one.min, "le": one.max} if one.type in _NUMBERS else {}
    if one.type == "text":
        bounds = {"max_length": LONGEST_TEXT}
    return Annotated[_TYPES[one.type], Field(description=about or None, **bounds)]


_NUMBERS = ("number", "integer")


def _meaning(one: Argument, value: Any) -> Any:
    if one.type == "choice":
        return one.meanings.get(value, value)
    return converted(value, one.times, one.plus)


def _samples(one: Argument) -> list[Any]:
    if one.type == "choice":
        return list(one.meanings) or [""]  # of a list that there is not, which is told by itself
    if one.type == "boolean":
        return [True, False]
    if one.type == "text":
        return ["text"]
    low = -_FAR if one.min is None else one.min
    high = _FAR if one.max is None else one.max
    if one.type == "integer":
        return [int(low), int(high)]
    # A number that is no whole one shows a field that takes only those.
    return [float(low), float(high), low + (high - low) / 3 + 0.01 * (high > low)]
