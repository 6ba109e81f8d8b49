"""The skills of any body that knows where it is and can drive somewhere by itself."""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Protocol

from pydantic import Field

from edgevox.agent.skills import Example, GoalHandle, OneOf, Result, Skill, skill
from edgevox.robots import navigation_words as words
from edgevox.robots.capabilities import Body, DrivesTo, HasBattery, HasPlaces, HasPose


class NavigableBody(Body, HasPose, HasPlaces, DrivesTo, Protocol):
    """What these skills need."""


def navigation_skills(
    body: NavigableBody,
    hints: Mapping[str, Sequence[str]] | None = None,
    aliases: Mapping[str, str] | None = None,
) -> tuple[Skill, ...]:
    """`navigate_to` (if there are places), `navigate_xy`, `stop`, `get_pose`, `battery` (if any).

    `hints` are sentences, by place, of people who want to be there: what a model learns from.
    `aliases` are other things that people say for a place, to that place.
    """
    skills = [_navigate_xy(body), _stop(body), _get_pose(body)]
    if body.places:
        skills.insert(0, _navigate_to(body, hints or {}, aliases or {}))
    if isinstance(body, HasBattery):
        skills.append(_battery(body))
    return tuple(skills)


def _navigate_to(
    body: NavigableBody, hints: Mapping[str, Sequence[str]], aliases: Mapping[str, str]
) -> Skill:
    places = tuple(body.places)

    @skill(
        templates=words.TO_ROOM,
        examples=_room_examples(places, hints),
        says="Going to the {room}.",
        done="I am in the {room}.",
    )
    def navigate_to(goal: GoalHandle, room: Annotated[str, OneOf(places, aliases)]) -> Result:
        """Drive to a room of the map."""
        x_m, y_m = body.places[room]
        body.drive_to(x_m, y_m, token=goal.token, report=goal.report)
        return {**_where(body), "room": room.replace("_", " ")}

    return navigate_to


def _navigate_xy(body: NavigableBody) -> Skill:
    @skill(
        templates=words.TO_POINT,
        examples=words.TO_POINT_EXAMPLES,
        says="Going to x {x:g}, y {y:g}.",
        done="I am at x {x:.1f}, y {y:.1f}.",
    )
    def navigate_xy(
        goal: GoalHandle,
        x: Annotated[float, Field(description="metres to the right, map frame")],
        y: Annotated[float, Field(description="metres up, map frame")],
    ) -> Result:
        """Drive to a point of the map, given by its coordinates in metres."""
        body.drive_to(x, y, token=goal.token, report=goal.report)
        return _where(body)

    return navigate_xy


def _stop(body: NavigableBody) -> Skill:
    @skill(
        templates=words.STOP,
        examples=words.STOP_EXAMPLES,
        says="Stopping.",
    )
    def stop(goal: GoalHandle) -> Result:
        """Stop moving at once and forget where it was going."""
        goal.token.check()
        return {"was_moving": body.halt("stop was asked")}

    return stop


def _get_pose(body: NavigableBody) -> Skill:
    @skill(
        templates=words.WHERE,
        examples=words.WHERE_EXAMPLES,
        done="I am {where}.",
        moves=False,
    )
    def get_pose(goal: GoalHandle) -> Result:
        """Say where the robot is: its room and its coordinates."""
        goal.token.check()
        return _where(body)

    return get_pose


def _battery(body: HasBattery) -> Skill:
    @skill(
        templates=words.BATTERY,
        examples=words.BATTERY_EXAMPLES,
        done="My battery is at {percent} percent.",
        moves=False,
    )
    def battery(goal: GoalHandle) -> Result:
        """Say how full the battery is."""
        goal.token.check()
        charge = body.battery()
        return {"charge": round(charge, 4), "percent": round(100 * charge)}

    return battery


def _room_examples(
    places: Sequence[str], hints: Mapping[str, Sequence[str]]
) -> tuple[Example, ...]:
    """One hint of each place in turn, six at most; without hints, sentences that name the place."""
    told = [
        (place, hint)
        for number in range(max((len(hints.get(place, ())) for place in places), default=0))
        for place in places
        for hint in hints.get(place, ())[number : number + 1]
    ]
    named = [
        (place, f"someone should look after the {place.replace('_', ' ')}") for place in places
    ]
    return tuple(Example(sentence, {"room": place}) for place, sentence in (told or named)[:6])


def _where(body: NavigableBody) -> dict[str, object]:
    pose = body.pose()
    room = body.place_at(pose.x_m, pose.y_m)
    point = f"at x {pose.x_m:.1f}, y {pose.y_m:.1f}"
    return {
        "x": round(pose.x_m, 3),
        "y": round(pose.y_m, 3),
        "yaw_deg": round(math.degrees(pose.yaw_rad), 1),
        "room": room.replace("_", " ") if room else None,
        "where": f"in the {room.replace('_', ' ')}, {point}" if room else point,
    }
