"""The skills of a body that walks: some metres straight on, some degrees round, standing."""

import math
from typing import Protocol

from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.agent.text.reasons import called_off
from edgevox.core.cancel import CancelToken
from edgevox.core.transforms import distance_on_floor
from edgevox.robots.capabilities import Report
from edgevox.robots.relative_skills import Distance, TurningBody, turning_skills, where


class WalkingBody(TurningBody, Protocol):
    """The methods that these skills need."""

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
    @skill(relative=True)
    def walk_forward(goal: GoalHandle, distance: Distance = 1.0) -> Result:
        """Walk straight ahead for a distance in metres."""
        return _walk(body, goal, distance)

    return walk_forward


def _walk_backward(body: WalkingBody) -> Skill:
    @skill(relative=True, towards_rad=math.pi)
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
