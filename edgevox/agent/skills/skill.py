"""Skills: typed Python functions that a sentence or a ROS 2 action can call.

A function's name, docstring and signature give its schema, its validation and (with the templates
beside it) the sentences that call it; of our own skills these stand in the phrasebooks:

    @skill(templates=["[please] (go|drive) to [the] {room}"], says="Going to the {room}.")
    def navigate_to(goal: GoalHandle, room: Annotated[str, OneOf(rooms)]) -> dict[str, object]:
        \"\"\"Drive to a room.\"\"\"

The first parameter is the goal that the call becomes; the others are the skill's arguments.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, Protocol, TypeVar, get_args, overload

from pydantic import BaseModel
from pydantic_core import PydanticKnownError, core_schema

from edgevox.agent.skills.arguments import (
    arguments_model,
    check_arguments,
    check_numbers,
    from_words,
)
from edgevox.agent.skills.failures import SkillFailed, UnknownSkill, reason_of
from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import name_form
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.reason import Reason

MOST_HINTS = 6
"""Number of an argument's words that examples name."""


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
        return dict(_spoken(tuple(self.aliases.items()), self.words))

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


@lru_cache(maxsize=64)
def _spoken(aliases: tuple[tuple[str, str], ...], words: tuple[str, ...]) -> Mapping[str, str]:
    return {_plain(said): word for said, word in (*aliases, *zip(words, words, strict=True))}


@lru_cache(maxsize=4096)
def _plain(word: str) -> str:
    text = word.casefold().replace("_", " ").strip()
    return " ".join(text.removeprefix("the ").split())


Result = Mapping[str, Any]
D = TypeVar("D")

STOP = "stop"
"""The name of the skill that halts the body; nothing ever forbids it."""


class GoalHandle(Protocol):
    """The goal, as a running skill sees it."""

    @property
    def token(self) -> CancelToken:
        """The token that is cancelled to end this goal."""

    def report(self, **feedback: Any) -> None:
        """Say how far it is, as JSON-ready values (``progress`` is 0 to 1)."""


def _takes_any_words(schema: Any) -> bool:
    """True if a value of this JSON schema can hold a string that the schema does not list."""
    if isinstance(schema, list):
        return any(_takes_any_words(one) for one in schema)
    if not isinstance(schema, Mapping) or "enum" in schema or "const" in schema:
        return False
    kinds = {
        "anyOf",
        "oneOf",
        "allOf",
        "items",
        "prefixItems",
        "additionalProperties",
    } & schema.keys()
    if kinds:
        return any(_takes_any_words(schema[kind]) for kind in kinds)
    return schema.get("type", "string") in {"string", "array", "object"}


@dataclass(frozen=True, slots=True)
class Example:
    """A sentence that no template catches, with its call, as an example for a small model."""

    sentence: str
    """The sentence."""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    """Arguments of the call."""


@dataclass(frozen=True, slots=True)
class SkillPhrases:
    """The phrases of one skill in one language."""

    can: str = ""
    """The ability as a part of a sentence."""
    actions: tuple[str, ...] = ()
    """The action as the end of a question, with the arguments; the first that fits counts."""
    orders: tuple[str, ...] = ()
    """The action as a person orders it, where that differs; the first that fits counts."""
    templates: tuple[str, ...] = ()
    """Templates of the sentences that call the skill."""
    asks: tuple[str, ...] = ()
    """Templates of the sentences that may call the skill, so that the robot asks first."""
    says: tuple[str, ...] = ()
    """Acknowledgements; the first whose values are all known counts."""
    done: tuple[str, ...] = ()
    """Reports of success; the first whose values are all known counts."""
    examples: tuple[Example, ...] = ()
    """Sentences that ask for it, whose words a reading learns."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Names of the arguments, for messages about a wrong one: "the number of rounds"."""
    words: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """Words for the values of an argument or result, by `value_key`: "true" of `docked` is "on my
    dock"."""


class Ready(Protocol):
    """Looks whether a skill can begin now, without beginning it."""

    def __call__(self, token: CancelToken, most_s: float, /, **arguments: Any) -> None:
        """Raise `SkillFailed` with the reason why it cannot, or `Cancelled` by the token.

        It may wait so many seconds for what it has not heard yet; with 0 it never blocks.
        """


@dataclass(frozen=True)
class Skill:
    """A skill of a robot."""

    name: str
    """The function's name."""
    description: str
    """The function's docstring, for people."""
    function: Callable[..., Result | None]
    """The function, which gets the goal and the arguments."""
    arguments_model: type[BaseModel]
    """The model that checks the arguments."""
    templates: tuple[str, ...] = ()
    """English templates of the sentences that call it."""
    examples: tuple[Example, ...] = ()
    """English sentences that ask for it, whose words a reading learns."""
    says: str = ""
    """English acknowledgement, formatted with the arguments."""
    done: str = ""
    """English report of success, formatted with the arguments and the result."""
    action: str = ""
    """English end of a question that begins "Shall I", formatted with the arguments."""
    moves: bool = True
    """True if it uses the body: it then runs beside the conversation and pre-empts other motion.
    Any other skill is answered while the turn waits."""
    phrases: Mapping[str, SkillPhrases] = field(default_factory=dict)
    """Phrases by language code, for a skill that no phrasebook knows."""
    check: Callable[..., None] | None = None
    """Raises `SkillFailed` for arguments that can never be honoured, such as a point outside the
    world, before a goal is accepted. Must be quick and do nothing else."""
    ready: "Ready | None" = None
    """Raises `SkillFailed` if it cannot begin now, before it replaces what moves the robot."""
    relative: bool = False
    """True if it moves by an amount and not to a place, so that it can go on further."""
    opposite: str = ""
    """Name of the skill that moves it the other way, by the same arguments; empty for none."""
    little: Mapping[str, float] = field(default_factory=dict)
    """What "a little" means for its arguments, said with the answer."""
    towards_rad: float = 0.0
    """Direction of its argument `distance`, counter-clockwise from the robot's heading."""
    lasting: bool = False
    """True if it changes something for good, for example forgets a place: the robot then asks first
    unless it was plainly said."""
    undoable: bool = False
    """True if it leaves nothing changed that a person could not take back by word, such as where
    the robot stands: a policy may then count down instead of asking."""
    entry: str = ""
    """Its entry in the phrasebooks, if several bodies have a skill of this name and people ask for
    it in different ways. A language without that entry uses the one with the skill's name."""
    confirm: bool = False
    """True if it always needs a yes, as if the policy wanted that."""
    brief: bool = False
    """True if it is over at once: without words of its own for its beginning, only its end is
    told."""
    plainly: bool = False
    """True if only its templates ask for it: no other words are read as it."""

    @property
    def drives(self) -> bool:
        """True if the skill sets the body in motion."""
        return self.moves and self.name != STOP

    @property
    def schema(self) -> dict[str, Any]:
        """JSON schema of the arguments object."""
        return self.arguments_model.model_json_schema()

    @property
    def choices(self) -> Mapping[str, OneOf]:
        """The arguments that take one of some words."""
        return {name: extra for name, extra in self._notes if isinstance(extra, OneOf)}

    @property
    def new_names(self) -> frozenset[str]:
        """The arguments that are new names."""
        return frozenset(name for name, extra in self._notes if isinstance(extra, NewName))

    @cached_property
    def _notes(self) -> Sequence[tuple[str, Any]]:
        """What annotates the arguments, each with its argument's name."""
        return [
            (name, extra)
            for name, info in self.arguments_model.model_fields.items()
            for extra in (*info.metadata, *get_args(info.annotation))
        ]

    @property
    def free_text(self) -> frozenset[str]:
        """The arguments that take any words, and so may hold words of the person."""
        if not self.arguments_model.model_fields:
            return frozenset()
        properties: Mapping[str, Any] = self.schema.get("properties", {})
        return frozenset(name for name, schema in properties.items() if _takes_any_words(schema))

    def validate(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Checked arguments, as the function takes them.

        Raises `InvalidValue` naming the first wrong one, or `SkillFailed` with the reason why
        nothing could come of them. The skill that stops takes any, and does without: a stop with
        wrong arguments is still a stop.
        """
        if self.name == STOP:
            return {}
        checked = check_arguments(self.name, self.arguments_model, arguments)
        if self.check:
            self.check(**checked)
        check_numbers(self.name, arguments)
        return checked

    def from_words(self, said: Mapping[str, str]) -> dict[str, Any]:
        """Words of a sentence as values of the arguments' types, where possible."""
        return from_words(self.arguments_model, said)


def skill(
    *,
    templates: Sequence[str] = (),
    examples: Sequence[Example] = (),
    says: str = "",
    done: str = "",
    action: str = "",
    moves: bool = True,
    phrases: Mapping[str, SkillPhrases] | None = None,
    check: Callable[..., None] | None = None,
    relative: bool = False,
    opposite: str = "",
    little: Mapping[str, float] | None = None,
    towards_rad: float = 0.0,
    lasting: bool = False,
    undoable: bool = False,
    entry: str = "",
    plainly: bool = False,
) -> Callable[[Callable[..., Result | None]], Skill]:
    """Turn a function into a `Skill`; see the module's docstring."""

    def decorate(function: Callable[..., Result | None]) -> Skill:
        return Skill(
            name=function.__name__,
            description=(inspect.getdoc(function) or "").partition("\n")[0],
            function=function,
            arguments_model=arguments_model(function),
            templates=tuple(templates),
            examples=tuple(examples),
            says=says,
            done=done,
            action=action,
            moves=moves,
            phrases=phrases or {},
            check=check,
            relative=relative,
            opposite=opposite,
            little=little or {},
            towards_rad=towards_rad,
            lasting=lasting,
            undoable=undoable,
            entry=entry,
            plainly=plainly,
        )

    return decorate


class SkillSet(Mapping[str, Skill]):
    """Skills by name, in the order they were given."""

    def __init__(self, skills: Iterable[Skill]) -> None:
        self._skills: dict[str, Skill] = {}
        for one in skills:
            if one.name in self._skills:
                raise InvalidValue("skill", one.name, "a name that is given only once")
            self._skills[one.name] = one

    def __getitem__(self, name: str) -> Skill:
        try:
            return self._skills[name]
        except KeyError:
            raise UnknownSkill(name, self._skills) from None

    @overload
    def get(self, name: str, default: None = None, /) -> Skill | None: ...
    @overload
    def get(self, name: str, default: D, /) -> Skill | D: ...
    def get(self, name: str, default: D | None = None, /) -> Skill | D | None:
        """The skill of that name, or the default: what `Mapping` has catches no `UnknownSkill`."""
        return self._skills.get(name, default)

    def __contains__(self, name: object) -> bool:
        return name in self._skills

    def __iter__(self) -> Iterator[str]:
        return iter(self._skills)

    def __len__(self) -> int:
        return len(self._skills)

    def words(self) -> tuple[tuple[tuple[str, str], ...], ...]:
        """All spoken forms of all words now; tables derived from other words are stale."""
        return tuple(
            tuple(choices.spoken().items())
            for one in self._skills.values()
            for choices in one.choices.values()
        )


NO_SKILLS = SkillSet(())


@dataclass(frozen=True, slots=True)
class Call:
    """A skill's name with arguments that are not yet checked."""

    skill: str
    arguments: Mapping[str, Any] = field(default_factory=dict)


def opposite_of(call: Call, skills: Mapping[str, Skill]) -> Call | None:
    """The same motion the other way; None if no skill makes it."""
    one = skills.get(call.skill)
    return Call(one.opposite, call.arguments) if one and one.opposite in skills else None


TO_POINT = "navigate_xy"
"""The skill that drives to where a body was."""
TO_PLACE = "navigate_to"
"""The skill that drives to a place by its name."""


def no_way_back(skills: Iterable[Skill]) -> Reason:
    """The reason why a robot cannot go back; another one if it cannot drive at all."""
    return because("cannot_go_back") if _goes(skills) else because("cannot_drive")


def no_further(skills: Iterable[Skill]) -> Reason:
    """The reason why a motion cannot go on further; another one if the robot cannot drive."""
    return because("not_relative") if _goes(skills) else because("has_no_further")


def _goes(skills: Iterable[Skill]) -> bool:
    return any(one.relative or one.name in (TO_POINT, TO_PLACE) for one in skills)


__all__ = [
    "NO_SKILLS",
    "STOP",
    "Call",
    "Example",
    "GoalHandle",
    "NewName",
    "OneOf",
    "OwnName",
    "Ready",
    "Result",
    "Skill",
    "SkillFailed",
    "SkillPhrases",
    "SkillSet",
    "UnknownSkill",
    "reason_of",
    "skill",
]
