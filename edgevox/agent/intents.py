"""Plain commands understood in milliseconds, by sentence templates that belong to the skills."""

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

from hassil import Intents, RecognizeResult, recognize_all
from pydantic.fields import FieldInfo

from edgevox.agent.numbers import digits
from edgevox.agent.skills import Call, OneOf, Skill, SkillSet

MAX_CHARACTERS = 240
"""Longer utterances are not plain commands; they go to the model."""

_PUNCTUATION = re.compile(r"[(){}\[\]<>|,;:=?!\"]+|\.(?!\d)")
_JOINTS = re.compile(
    r"\s*(?:,|;|\.(?!\d)|\b)\s*(?:and then|then|and afterwards|and|after that)\s+|[;.](?!\d)\s+",
    re.IGNORECASE,
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_PAIR = re.compile(rf"({_NUMBER.pattern})\s*,?\s+(?={_NUMBER.pattern}(?:\s|\W*$))")
_ARTICLES = re.compile(r"\b(?:the|a|an|my|our)\b")
_NOTHING = "nothingatall"
_MAX_UNKNOWN_WORDS = 3
_CLAUSE_WORDS = frozenset(
    {"where", "which", "that", "who", "what", "there", "here", "it", "and", "to"}
)


@dataclass(frozen=True, slots=True)
class Understood:
    """The utterance is these calls."""

    calls: tuple[Call, ...]


@dataclass(frozen=True, slots=True)
class Refused:
    """A plain command in which a word is missing or unknown; `reason` says which."""

    reason: str


class Recogniser:
    """Matches utterances against the templates of a set of skills.

    An utterance may join several commands ("go to the kitchen, then tell me your battery"); all of
    its parts must match. A word that no argument knows is corrected when it is nearly one
    ("kichen"), and refused by name otherwise: a robot never guesses where to drive.
    """

    def __init__(self, skills: SkillSet, language: str = "en") -> None:
        self._skills = skills
        self._language = language
        self._strict = _compile(skills, language, loose=False)
        self._loose = _compile(skills, language, loose=True)

    def recognise(self, text: str) -> Understood | Refused | None:
        """Calls, a refusal, or None when this is not a plain command."""
        if len(text) > MAX_CHARACTERS:
            return None
        plain = digits(" ".join(text.split()), self._language)
        whole = self._one(plain)
        if isinstance(whole, Call):
            return Understood((whole,))
        parts = [part for part in _JOINTS.split(plain) if part.strip()]
        if len(parts) > 1:
            found = [self._one(part) for part in parts]
            calls = tuple(part for part in found if isinstance(part, Call))
            if len(calls) == len(parts):
                return Understood(calls)
            refusals = [part for part in found if isinstance(part, Refused)]
            return refusals[0] if refusals and len(calls) + len(refusals) == len(parts) else None
        return whole

    def _one(self, part: str) -> Call | Refused | None:
        """The call that this sentence is; two bare numbers side by side are read as "x and y"."""
        sentence = " ".join(_PUNCTUATION.sub(" ", _PAIR.sub(r"\1 and ", part)).split())
        for call in self._matches(sentence, self._strict):
            return call
        for call in self._matches(sentence, self._loose):
            return self._repair(call)
        for call in self._matches(f"{sentence} {_NOTHING}", self._loose):
            if any(value == _NOTHING for value in call.arguments.values()):
                return self._repair(call)
        return None

    def _matches(self, sentence: str, intents: Intents) -> Iterator[Call]:
        for result in recognize_all(sentence, intents):
            arguments = _arguments(self._skills[result.intent.name], result)
            if arguments is not None:
                yield Call(result.intent.name, arguments)

    def _repair(self, call: Call) -> Call | Refused | None:
        """Correct near misses among the words of a loose match, or say what is wrong."""
        arguments = dict(call.arguments)
        for name, choices in _choices(self._skills[call.skill]).items():
            words = _ARTICLES.sub(" ", str(arguments.get(name, "")).casefold()).split()
            if words in ([], [_NOTHING]):
                return Refused(f"I did not hear which {name}. I know {_list(choices.words)}.")
            if not _names_something(words):
                return None
            said, spoken = " ".join(words), choices.spoken()
            near = difflib.get_close_matches(said, spoken, n=1, cutoff=0.8)
            if not near:
                return Refused(f"I do not know the {name} {said!r}. I know {_list(choices.words)}.")
            arguments[name] = spoken[near[0]]
        return Call(call.skill, arguments)


def _compile(skills: SkillSet, language: str, *, loose: bool) -> Intents:
    """Intents, one per skill; `loose` lets any words stand where one of some words should."""
    data = {
        name: {"data": [{"sentences": list(one.templates), "lists": _lists(one, loose=loose)}]}
        for name, one in skills.items()
        if one.templates and (not loose or _choices(one))
    }
    return Intents.from_dict({"language": language, "intents": data})


def _lists(one: Skill, *, loose: bool) -> dict[str, Any]:
    lists: dict[str, Any] = {}
    for name, info in one.arguments_model.model_fields.items():
        choices = _one_of(info)
        if choices is None or loose:
            lists[name] = {"wildcard": True}
        else:
            values = [{"in": said, "out": word} for said, word in choices.spoken().items()]
            lists[name] = {"values": values}
    return lists


def _arguments(one: Skill, result: RecognizeResult) -> Mapping[str, Any] | None:
    """The match's slots as arguments, or None where a number was expected and none was said."""
    arguments: dict[str, Any] = {}
    for name, entity in result.entities.items():
        info = one.arguments_model.model_fields[name]
        value = str(entity.value).strip()
        if info.annotation in (int, float):
            if not _NUMBER.fullmatch(value):
                return None
            arguments[name] = float(value)
        else:
            arguments[name] = value
    return arguments


def _choices(one: Skill) -> Mapping[str, OneOf]:
    found = {name: _one_of(info) for name, info in one.arguments_model.model_fields.items()}
    return {name: choices for name, choices in found.items() if choices is not None}


def _one_of(info: FieldInfo) -> OneOf | None:
    for extra in (*info.metadata, *get_args(info.annotation)):
        if isinstance(extra, OneOf):
            return extra
    return None


def _names_something(words: Sequence[str]) -> bool:
    """Whether these words may be a name, and not a clause or a number."""
    return (
        len(words) <= _MAX_UNKNOWN_WORDS
        and not _CLAUSE_WORDS.intersection(words)
        and not any(character.isdigit() for word in words for character in word)
    )


def _list(words: Sequence[str]) -> str:
    spoken = [word.replace("_", " ") for word in words]
    return spoken[0] if len(spoken) == 1 else f"{', '.join(spoken[:-1])} and {spoken[-1]}"
