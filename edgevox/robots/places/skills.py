"""Skills of a body that can be told what a place is called: remember it, forget it, list them."""

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Protocol

from pydantic import Field

from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.agent.skills.skill import NewName, OneOf
from edgevox.agent.text.reasons import because
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import MAP, Pose2D
from edgevox.robots.capabilities import HasPose, KnowsFrame
from edgevox.robots.places.memory import PlaceMemory

REMEMBER = "remember_place"
"""The skill that gives a name to where the robot stands, or to a point of its map."""

CheckGoal = Callable[[float, float], None]
"""Raises `SkillFailed` for a point that is outside the robot's world; metres, map frame."""

STILL_M_S, STILL_RAD_S = 0.05, 0.1
"""Slower than this a robot stands; odometry of real ones is never quite still."""


class StandsSomewhere(HasPose, Protocol):
    """The capabilities that these skills need."""

    @property
    def places(self) -> Mapping[str, tuple[float, float]]: ...
    def state(self) -> Mapping[str, Any]: ...


def place_skills(
    body: StandsSomewhere, memory: PlaceMemory, known: OneOf, noun: str, check_goal: CheckGoal
) -> tuple[Skill, ...]:
    """`remember_place`, `forget_place`, `list_places`.

    `known` are all places that there are, `noun` is what the argument of one of them is called,
    `check_goal` judges a point that is to be remembered.
    """
    return (
        _remember_place(body, memory, check_goal),
        _forget_place(memory, known, noun),
        _list_places(body, memory),
    )


def located(body: StandsSomewhere) -> tuple[Pose2D, str]:
    """Return the body's pose and its frame. Raises `SkillFailed` while that is unknown."""
    return body.located() if isinstance(body, KnowsFrame) else (body.pose(), MAP)


def _remember_place(body: StandsSomewhere, memory: PlaceMemory, check_goal: CheckGoal) -> Skill:
    def check(name: str, x: float | None, y: float | None) -> None:
        memory.check(name)
        _point(x, y, check_goal)

    @skill(moves=False, lasting=True, check=check)
    def remember_place(
        goal: GoalHandle,
        name: Annotated[str, NewName()],
        x: Annotated[float | None, Field(description="metres, map frame, of another point")] = None,
        y: Annotated[float | None, Field(description="metres, map frame, of another point")] = None,
    ) -> Result:
        """Remember the place where the robot stands now by a new name."""
        goal.token.check()
        pose, frame = located(body)
        if point := _point(x, y, check_goal):
            place = memory.remember(name, Pose2D(*point, 0.0), frame, facing=False)
        else:
            _check_still(body)
            place = memory.remember(name, pose, frame)
        return {"name": name, "x": place.x, "y": place.y, "yaw": place.yaw, "frame": frame}

    return remember_place


def _point(
    x_m: float | None, y_m: float | None, check_goal: CheckGoal
) -> tuple[float, float] | None:
    """The point that was given, None for where the robot stands. Raises `SkillFailed` for one
    that is not in its world, and `InvalidValue` for half of one.
    """
    if x_m is None and y_m is None:
        return None
    if x_m is None or y_m is None:
        raise InvalidValue(f"{REMEMBER}.{'x' if x_m is None else 'y'}", None, "a number")
    check_goal(x_m, y_m)
    return x_m, y_m


def _check_still(body: StandsSomewhere) -> None:
    """Raise `SkillFailed` while it moves: nobody knows which point of its way was meant."""
    twist = body.velocity()
    moving = abs(twist.linear_m_s) > STILL_M_S or abs(twist.angular_rad_s) > STILL_RAD_S
    if moving or body.state().get("goal"):
        raise SkillFailed(because("place_while_moving"))


def _forget_place(memory: PlaceMemory, known: OneOf, noun: str) -> Skill:
    def forget_room(goal: GoalHandle, room: Annotated[str, known]) -> Result:
        """Forget a place that the robot was told to remember."""
        goal.token.check()
        memory.forget(room)
        return {"name": room}

    def forget_location(goal: GoalHandle, location: Annotated[str, known]) -> Result:
        """Forget a place that the robot was told to remember."""
        return forget_room(goal, location)

    forget_place = forget_room if noun == "room" else forget_location
    forget_place.__name__ = "forget_place"
    return skill(moves=False, lasting=True)(forget_place)


def _list_places(body: StandsSomewhere, memory: PlaceMemory) -> Skill:
    @skill(moves=False)
    def list_places(goal: GoalHandle) -> Result:
        """Say which places the robot knows by name."""
        goal.token.check()
        own = {
            name: {"x": x_m, "y": y_m, "remembered": False}
            for name, (x_m, y_m) in body.places.items()
        }
        learned = [one for name in memory.names() if (one := memory.find(name))]
        remembered = {
            one.name: {**one.model_dump(include={"x", "y", "yaw", "frame"}), "remembered": True}
            for one in learned
        }
        names = [*own, *remembered]
        return {"places": own | remembered, "names": names}

    return list_places
