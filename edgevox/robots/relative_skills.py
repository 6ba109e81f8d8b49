"""Skills that go by an amount from where the body stands: some degrees round, some metres straight.

`turning_skills` are the same for legs and wheels, `driving_skills` are for wheels, `walking_skills`
for legs.
"""

import math
from typing import Annotated, Protocol

from pydantic import Field

from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.agent.text.reasons import because, called_off, number
from edgevox.core.cancel import CancelToken
from edgevox.core.transforms import Pose2D, distance_on_floor, turn_between
from edgevox.robots.capabilities import Body, HasPose, Report

LEAST_M, MOST_M = 0.05, 20.0
LEAST_DEG, MOST_DEG = 1.0, 720.0
_WORTH_SAYING_M = 0.05
_LITTLE_M, _LITTLE_DEG = {"distance": 0.3}, {"degrees": 20.0}

Distance = Annotated[float, Field(ge=LEAST_M, le=MOST_M, description="metres")]
Degrees = Annotated[float, Field(ge=LEAST_DEG, le=MOST_DEG, description="degrees")]


class TurningBody(Body, HasPose, Protocol):
    """The methods that the skills of turning need."""

    def turn(self, angle_rad: float, *, token: CancelToken, report: Report) -> None:
        """Block until it stands turned by that to the left. Raises `SkillFailed`."""


class DrivingBody(TurningBody, Protocol):
    """The methods that the skills of driving need."""

    def drive_straight(self, distance_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until it stands that far ahead, or back if negative. Raises `SkillFailed`.

        It goes straight or not at all: it stops for what is in its way, and goes round nothing.
        """


def driving_skills(body: DrivingBody) -> tuple[Skill, ...]:
    """`drive_forward`, `drive_backward`, and those of `turning_skills`."""
    return (_drive_forward(body), _drive_backward(body), *turning_skills(body))


def turning_skills(body: TurningBody) -> tuple[Skill, ...]:
    """`turn_left`, `turn_right`, `turn_around`."""
    return (_turn_left(body), _turn_right(body), _turn_around(body))


def where(pose: Pose2D) -> dict[str, float]:
    """A body's pose, as a part of a result."""
    return {
        "x": round(pose.x_m, 3),
        "y": round(pose.y_m, 3),
        "yaw_deg": round(math.degrees(pose.yaw_rad), 1),
    }


def _drive_forward(body: DrivingBody) -> Skill:
    @skill(relative=True, undoable=True, opposite="drive_backward", little=_LITTLE_M)
    def drive_forward(goal: GoalHandle, distance: Distance = 1.0) -> Result:
        """Drive straight ahead for a distance in metres, around nothing."""
        return _drive(body, goal, distance)

    return drive_forward


def _drive_backward(body: DrivingBody) -> Skill:
    @skill(
        relative=True,
        undoable=True,
        opposite="drive_forward",
        little=_LITTLE_M,
        towards_rad=math.pi,
    )
    def drive_backward(goal: GoalHandle, distance: Distance = 1.0) -> Result:
        """Drive straight back for a distance in metres, where it can see behind itself."""
        return _drive(body, goal, -distance)

    return drive_backward


def _turn_left(body: TurningBody) -> Skill:
    @skill(relative=True, undoable=True, opposite="turn_right", little=_LITTLE_DEG)
    def turn_left(goal: GoalHandle, degrees: Degrees = 90.0) -> Result:
        """Turn to the left on the spot, by an angle in degrees."""
        return _turn(body, goal, degrees)

    return turn_left


def _turn_right(body: TurningBody) -> Skill:
    @skill(relative=True, undoable=True, opposite="turn_left", little=_LITTLE_DEG)
    def turn_right(goal: GoalHandle, degrees: Degrees = 90.0) -> Result:
        """Turn to the right on the spot, by an angle in degrees."""
        return _turn(body, goal, -degrees)

    return turn_right


def _turn_around(body: TurningBody) -> Skill:
    @skill(undoable=True)
    def turn_around(goal: GoalHandle) -> Result:
        """Turn around, to look the other way."""
        return _turn(body, goal, 180.0)

    return turn_around


def _drive(body: DrivingBody, goal: GoalHandle, distance_m: float) -> Result:
    before = body.pose()
    try:
        body.drive_straight(distance_m, token=goal.token, report=goal.report)
    except SkillFailed as failure:
        driven_m = distance_on_floor(before, body.pose())
        if driven_m < _WORTH_SAYING_M:
            raise
        raise SkillFailed(
            because("stopped_short", driven=number(driven_m), why=failure.reason)
        ) from failure
    return {**where(body.pose()), "driven": round(distance_on_floor(before, body.pose()), 3)}


def _turn(body: TurningBody, goal: GoalHandle, degrees: float) -> Result:
    before = body.pose()
    body.turn(math.radians(degrees), token=goal.token, report=goal.report)
    off = turn_between(math.radians(degrees), body.pose().yaw_rad - before.yaw_rad)
    return {**where(body.pose()), "turned": round(abs(degrees + math.degrees(off)), 1)}


class WalkingBody(TurningBody, Protocol):
    """The methods that the skills of walking need."""

    def walk(self, distance_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until it stands that far ahead, or back if negative. Raises `SkillFailed`."""

    def stand(self, *, token: CancelToken, report: Report) -> bool:
        """Block until it stands; True if it lay on the floor and was put upright."""


def walking_skills(body: WalkingBody) -> tuple[Skill, ...]:
    """`walk_forward`, `walk_backward`, `turn_left`, `turn_right`, `turn_around`, and the rest."""
    return (
        _walk_forward(body),
        _walk_backward(body),
        *turning_skills(body),
        _stand(body),
        _stop(body),
        _get_pose(body),
    )


def _walk_forward(body: WalkingBody) -> Skill:
    @skill(relative=True, undoable=True, opposite="walk_backward", little=_LITTLE_M)
    def walk_forward(goal: GoalHandle, distance: Distance = 1.0) -> Result:
        """Walk straight ahead for a distance in metres."""
        return _walk(body, goal, distance)

    return walk_forward


def _walk_backward(body: WalkingBody) -> Skill:
    @skill(
        relative=True, undoable=True, opposite="walk_forward", little=_LITTLE_M, towards_rad=math.pi
    )
    def walk_backward(goal: GoalHandle, distance: Distance = 1.0) -> Result:
        """Walk straight back for a distance in metres."""
        return _walk(body, goal, -distance)

    return walk_backward


def _stand(body: WalkingBody) -> Skill:
    @skill()
    def stand(goal: GoalHandle) -> Result:
        """Stand still; after a fall, get up again."""
        got_up = body.stand(token=goal.token, report=goal.report)
        return {**where(body.pose()), "got_up": got_up}

    return stand


def _stop(body: WalkingBody) -> Skill:
    @skill(entry="stop_walking")
    def stop(goal: GoalHandle) -> Result:
        """Stop walking at once."""
        goal.token.check()
        return {"was_moving": body.halt(str(called_off("stop_asked")))}

    return stop


def _get_pose(body: WalkingBody) -> Skill:
    @skill(entry="get_pose_walking", moves=False)
    def get_pose(goal: GoalHandle) -> Result:
        """Say where the robot is, which way it looks, and whether it has fallen."""
        goal.token.check()
        fallen = bool(body.state()["fallen"])
        return {**where(body.pose()), "fallen": fallen, "upright": not fallen}

    return get_pose


def _walk(body: WalkingBody, goal: GoalHandle, distance_m: float) -> Result:
    before = body.pose()
    body.walk(distance_m, token=goal.token, report=goal.report)
    after = body.pose()
    return {**where(body.pose()), "walked": round(distance_on_floor(before, after), 3)}
