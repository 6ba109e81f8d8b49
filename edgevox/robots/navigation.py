"""The skills of any body that knows where it is and can drive somewhere by itself."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Protocol, runtime_checkable

from pydantic import Field

from edgevox.agent.skills import Example, GoalHandle, OneOf, Result, Skill, SkillFailed, skill
from edgevox.agent.skills.skill import MOST_HINTS, OwnNames
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import CancelToken
from edgevox.core.transforms import Pose2D, turn_between
from edgevox.robots.capabilities import (
    Body,
    ChecksGoals,
    DrivesTo,
    HasBattery,
    HasPlaces,
    HasPose,
    Report,
)
from edgevox.robots.facts import battery_skill
from edgevox.robots.limits import Bounds
from edgevox.robots.places.memory import Place, PlaceMemory
from edgevox.robots.places.skills import located, place_skills
from edgevox.robots.relative_skills import where
from edgevox.robots.world.fields import LARGEST


class NavigableBody(Body, HasPose, HasPlaces, DrivesTo, Protocol):
    """The capabilities that these skills need."""


@runtime_checkable
class DrivesToPlaces(Protocol):
    """Knows more of a place than its point, such as which way to look there."""

    def drive_to_place(self, place: str, *, token: CancelToken, report: Report) -> None:
        """Drive there, like `drive_to`."""


@runtime_checkable
class DrivesToPoses(Protocol):
    """Can look a given way where it has driven."""

    def drive_to_pose(self, pose: Pose2D, *, token: CancelToken, report: Report) -> None:
        """Drive there, like `drive_to`."""


@runtime_checkable
class Turns(Protocol):
    """Can turn on the spot."""

    def turn(self, angle_rad: float, *, token: CancelToken, report: Report) -> None:
        """Block until it stands turned by that to the left. Raises `SkillFailed`."""


@dataclass(frozen=True, slots=True)
class PlaceWord:
    """The body's word for its places: the name of the argument that is one."""

    noun: str


_HERE_M = 0.05
"""Nearer than this to a place, a body has no direction in which the place lies."""
_ANYWHERE = Bounds.around("map", LARGEST)
"""The world of a body that does not say where its own ends."""
ROOM = PlaceWord("room")
LOCATION = PlaceWord("location")
TURN_TOWARDS = "turn_towards"


def navigation_skills(
    body: NavigableBody,
    hints: Mapping[str, Sequence[str]] | None = None,
    aliases: Mapping[str, str] | None = None,
    word: PlaceWord = ROOM,
    memory: PlaceMemory | None = None,
    *,
    names: OwnNames | None = None,
) -> tuple[Skill, ...]:
    """`navigate_to` (if there are places), `navigate_xy`, `stop`, `get_pose`, `battery` (if any).

    A body that turns on the spot also has `turn_towards`, which looks where a place is. With a
    `memory` there are those of `place_skills` as well, and both take what it remembers.

    `hints` are sentences, by place, of people who want to be there: their words are learned.
    `aliases` are other things that people say for a place, to that place, `names` what a place is
    called by language. `word` is `ROOM` or
    `LOCATION`, and the name of `navigate_to`'s argument.
    """
    skills = [_navigate_xy(body, word), _stop(body), _get_pose(body, word)]
    known = OneOf(tuple(body.places), aliases or {}, memory.names if memory else tuple, names or {})
    if body.places or memory:
        skills.insert(0, _navigate_to(body, hints or {}, known, word, memory))
        if isinstance(body, Turns):
            skills.insert(1, _turn_towards(body, known, word, memory))
    if isinstance(body, HasBattery):
        skills.append(battery_skill(body))
    if memory:
        skills += place_skills(body, memory, known, word.noun, partial(check_goal, body))
    return tuple(skills)


def _navigate_to(
    body: NavigableBody,
    hints: Mapping[str, Sequence[str]],
    known: OneOf,
    word: PlaceWord,
    memory: PlaceMemory | None,
) -> Skill:
    def navigate_to_room(goal: GoalHandle, room: Annotated[str, known]) -> Result:
        """Drive to a room of the map."""
        return _go(body, goal, room, word, memory)

    def navigate_to_location(goal: GoalHandle, location: Annotated[str, known]) -> Result:
        """Drive to a known location of the map."""
        return _go(body, goal, location, word, memory)

    navigate_to = navigate_to_room if word is ROOM else navigate_to_location
    return _named(
        "navigate_to",
        navigate_to,
        examples=_hints_in_turn(known.fixed, hints, word),
        undoable=True,
    )


def _named(name: str, run: Callable[..., Result], **about: Any) -> Skill:
    """Return a skill of this name; its function has another one for its place's word."""
    run.__name__ = name
    return skill(**about)(run)


def _go(
    body: NavigableBody,
    goal: GoalHandle,
    place: str,
    word: PlaceWord,
    memory: PlaceMemory | None,
) -> Result:
    if place not in body.places:
        _go_back(body, goal, memory.find(place) if memory else None, place)
    elif isinstance(body, DrivesToPlaces):
        body.drive_to_place(place, token=goal.token, report=goal.report)
    else:
        x_m, y_m = body.places[place]
        body.drive_to(x_m, y_m, token=goal.token, report=goal.report)
    name = place.replace("_", " ")
    at = {word.noun: name} if place in body.places else {word.noun: name, LOCATION.noun: name}
    return {**_where(body, word), **at}


def _turn_towards(
    body: NavigableBody, known: OneOf, word: PlaceWord, memory: PlaceMemory | None
) -> Skill:
    def towards_room(goal: GoalHandle, room: Annotated[str, known]) -> Result:
        """Turn on the spot, to look to where a room is."""
        return _turn(body, goal, room, word, memory)

    def towards_location(goal: GoalHandle, location: Annotated[str, known]) -> Result:
        """Turn on the spot, to look to where a known location is."""
        return _turn(body, goal, location, word, memory)

    towards = towards_room if word is ROOM else towards_location
    return _named(TURN_TOWARDS, towards, plainly=True, undoable=True)


def _turn(
    body: NavigableBody, goal: GoalHandle, place: str, word: PlaceWord, memory: PlaceMemory | None
) -> Result:
    pose = body.pose()
    if place in body.places:
        x_m, y_m = body.places[place]
    else:
        there = _remembered(body, memory.find(place) if memory else None, place)
        x_m, y_m = there.x, there.y
    if math.dist((x_m, y_m), (pose.x_m, pose.y_m)) > _HERE_M and isinstance(body, Turns):
        angle_rad = turn_between(pose.yaw_rad, math.atan2(y_m - pose.y_m, x_m - pose.x_m))
        body.turn(angle_rad, token=goal.token, report=goal.report)
    return {**where(body.pose()), word.noun: place.replace("_", " ")}


def _go_back(body: NavigableBody, goal: GoalHandle, there: Place | None, name: str) -> None:
    """Drive to where the body was told that a place is."""
    there = _remembered(body, there, name)
    if isinstance(body, DrivesToPoses) and there.yaw is not None:
        pose = Pose2D(there.x, there.y, there.yaw)
        body.drive_to_pose(pose, token=goal.token, report=goal.report)
    else:
        body.drive_to(there.x, there.y, token=goal.token, report=goal.report)


def _remembered(body: NavigableBody, there: Place | None, name: str) -> Place:
    """A remembered place, in the frame that the body knows itself in. Raises `SkillFailed`."""
    if there is None:  # forgotten since the goal was accepted
        raise SkillFailed(because("place_unknown", place=name))
    frame = located(body)[1]
    if frame != there.frame:
        raise SkillFailed(because("place_elsewhere", place=name, was=there.frame, frame=frame))
    return there


def _navigate_xy(body: NavigableBody, word: PlaceWord) -> Skill:
    @skill(check=lambda x, y: check_goal(body, x, y), undoable=True)
    def navigate_xy(
        goal: GoalHandle,
        x: Annotated[float, Field(description="metres to the right, map frame")],
        y: Annotated[float, Field(description="metres up, map frame")],
    ) -> Result:
        """Drive to a point of the map, given by its coordinates in metres."""
        body.drive_to(x, y, token=goal.token, report=goal.report)
        return _where(body, word)

    return navigate_xy


def check_goal(body: Body, x_m: float, y_m: float) -> None:
    """Raise `SkillFailed` for a point that is outside this body's world, or any."""
    if isinstance(body, ChecksGoals):
        body.check_goal(x_m, y_m)
    else:
        _ANYWHERE.check(x_m, y_m)


def _stop(body: NavigableBody) -> Skill:
    @skill()
    def stop(goal: GoalHandle) -> Result:
        """Stop moving at once and forget where it was going."""
        goal.token.check()
        return {"was_moving": body.halt(str(called_off("stop_asked")))}

    return stop


def _get_pose(body: NavigableBody, word: PlaceWord) -> Skill:
    @skill(moves=False)
    def get_pose(goal: GoalHandle) -> Result:
        """Say where the robot is: its room and its coordinates."""
        goal.token.check()
        return _where(body, word)

    return get_pose


def _hints_in_turn(
    places: Sequence[str], hints: Mapping[str, Sequence[str]], word: PlaceWord
) -> tuple[Example, ...]:
    """Return a few examples, one hint of each place in turn.

    If none, the phrasebooks' examples count.
    """
    told = [
        Example(hint, {word.noun: place})
        for number in range(max((len(hints.get(place, ())) for place in places), default=0))
        for place in places
        for hint in hints.get(place, ())[number : number + 1]
    ]
    return tuple(told[:MOST_HINTS])


def _where(body: NavigableBody, word: PlaceWord) -> dict[str, object]:
    pose = body.pose()
    place = body.place_at(pose.x_m, pose.y_m)
    return {**where(pose), word.noun: place.replace("_", " ") if place else None}
