"""Failures of calls: exceptions for programs, each with a reason for people."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError

from edgevox.agent.text.reasons import because
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.validation import dotted, explain
from edgevox.core.reason import Reason

MOST_CHARACTERS = 40
"""Number of characters of a wrong value that are said."""

_NO_NUMBER = ("float_type", "float_parsing", "int_type", "int_parsing", "finite_number")
_LIMITS = ("le", "lt", "ge", "gt")
_UNKNOWN = {"extra_forbidden": "no such argument"}


class WrongArgument(InvalidValue):
    """A part of a call that cannot be honoured. `why` is the same as a person may hear it."""

    def __init__(
        self, field: str, value: object, expected: str, why: Callable[[str], Reason]
    ) -> None:
        super().__init__(field, value, expected)
        self.why = why(str(self))


def wrong_argument(skill: str, model: type[BaseModel], error: ValidationError) -> WrongArgument:
    """The first thing that is wrong with the arguments of a skill, by their model's error."""
    found = explain(error, lambda place: f"{skill}.{dotted(place) or 'arguments'}", _UNKNOWN)
    first = error.errors(include_url=False)[0]
    name = str(first["loc"][0]) if first["loc"] else "arguments"
    choices = _choices(model, name) if first["type"] == "literal_error" else ()
    limits: Mapping[str, Any] = first.get("ctx", {})
    limit = next((limits[one] for one in _LIMITS if one in limits), "")
    wrong = _Wrong(name, spoken(found.value), spoken(limit), choices)
    return WrongArgument(
        found.field, found.value, found.expected, lambda text: wrong.because(first["type"], text)
    )


def impossible(field: str, argument: str, value: object, expected: str) -> WrongArgument:
    """A value that no skill takes."""

    def why(text: str) -> Reason:
        return because("wrong_value", text, argument=argument, value=spoken(value))

    return WrongArgument(field, value, expected, why)


def too_many_calls(count: int, most: int) -> WrongArgument:
    """A sentence that asks for more than is done at once."""

    def why(text: str) -> Reason:
        return because("too_many_calls", text, count=str(count), limit=str(most))

    return WrongArgument("calls", count, f"at most {most} in one sentence", why)


@dataclass(frozen=True, slots=True)
class _Wrong:
    """One wrong argument: what it was, and what it may be."""

    argument: str
    value: str
    limit: str
    choices: tuple[str, ...]

    def because(self, kind: str, text: str) -> Reason:
        """The reason for an error of pydantic's of this kind."""
        named = {"argument": self.argument, "value": self.value}
        match kind:
            case "less_than_equal" | "less_than":
                return because("too_large", text, **named, limit=self.limit)
            case "greater_than_equal" | "greater_than":
                return because("too_small", text, **named, limit=self.limit)
            case "missing":
                return because("missing_argument", text, argument=self.argument)
            case "extra_forbidden":
                return because("unknown_argument", text, argument=self.argument)
            case "literal_error" if self.choices:
                return because("not_one_of", text, value=self.value, choices=self.choices)
            case "int_from_float":
                return because("no_whole_number", text, **named)
            case _ if kind in _NO_NUMBER:
                return because("no_number", text, **named)
        return because("wrong_value", text, **named)


def _choices(model: type[BaseModel], argument: str) -> tuple[str, ...]:
    """The words that an argument may be, alone or beside nothing."""
    schema: Mapping[str, Any] = model.model_json_schema()["properties"].get(argument, {})
    kinds = [schema, *schema.get("anyOf", ())]
    found = [kind.get("enum", [kind["const"]] if "const" in kind else []) for kind in kinds]
    return tuple(str(word) for words in found for word in words)


def spoken(value: object) -> str:
    """A value as it may be said: not all of a long one, and nothing of one that is no word."""
    if not isinstance(value, str | int | float):
        return "…"
    said = f"{value:g}" if isinstance(value, float) else str(value)
    return said if len(said) <= MOST_CHARACTERS else f"{said[:MOST_CHARACTERS]}…"


class SkillFailed(EdgeVoxError):
    """A skill could not do what was asked. The message is a reason that a person may hear.

    A `Reason` with a code is said in the language that is spoken, a plain sentence as it is.
    """

    def __init__(self, reason: Reason | str) -> None:
        self.reason = reason if isinstance(reason, Reason) else Reason(reason)
        super().__init__(self.reason.text)


def reason_of(error: EdgeVoxError) -> Reason:
    """The reason of an exception."""
    if isinstance(error, WrongArgument):
        return error.why
    return error.reason if isinstance(error, SkillFailed) else Reason(str(error))


class UnknownSkill(WrongArgument):
    """A call names a skill that this agent does not have."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        names = tuple(known)

        def why(text: str) -> Reason:
            return because("unknown_skill", text, skill=spoken(name), skills=names)

        super().__init__("skill", name, "one of " + ", ".join(names), why)
