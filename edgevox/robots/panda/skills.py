"""The skills of an arm that moves cubes about a table."""

from typing import Annotated, Any, Protocol

from pydantic import Field

from edgevox.agent.skills import GoalHandle, OneOf, Result, Skill, SkillFailed, skill
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import CancelToken
from edgevox.robots.capabilities import Body, Report
from edgevox.robots.panda.layout import BINS, CUBES, FAR_M, TABLE

IT = "it"
"""The word for the thing that is held."""

_THINGS = ("cube", "block", "box", "brick", "object", "thing", "one", "1")
"""The last is how "one" arrives after numbers were written as digits."""
CUBE_WORDS = {f"{name.split('_')[0]} {noun}": name for name in CUBES for noun in _THINGS} | {
    name.split("_")[0]: name for name in CUBES
}
_HELD_WORDS = dict.fromkeys(("that", "this", "the object", "held object", "what you hold"), IT)
BIN_WORDS = {
    said: name
    for name in BINS
    for side in (name.split("_")[0],)
    for said in (
        *(f"{side} {noun}" for noun in ("box", "tray", "container", "basket", "bucket")),
        f"bin on the {side}",
        f"box on the {side}",
        side,
    )
}
TABLE_WORDS = {"table top": TABLE, "tabletop": TABLE, "desk": TABLE, "its place": TABLE}


class Manipulator(Body, Protocol):
    """The body that these skills need.

    Motions block and raise `SkillFailed` with a reason, or `Cancelled` if the token is cancelled.
    """

    def move_to(
        self, x_m: float, y_m: float, z_m: float, *, token: CancelToken, report: Report
    ) -> None: ...

    def grasp(self, name: str, *, token: CancelToken, report: Report) -> None: ...

    def place(
        self, name: str | None, target: str, *, token: CancelToken, report: Report
    ) -> str: ...

    def release(self, *, token: CancelToken, report: Report) -> str | None: ...

    def go_home(self, *, token: CancelToken, report: Report) -> None: ...

    def describe_hand(self) -> dict[str, Any]: ...

    def describe_objects(self) -> dict[str, Any]: ...


def manipulation_skills(body: Manipulator) -> tuple[Skill, ...]:
    """`move_to`, `grasp`, `place`, `release`, `goto_home`, `stop`, `get_pose`, `list_objects`."""
    return (*_carrying(body), *_moving(body), *_telling(body))


def _carrying(body: Manipulator) -> tuple[Skill, ...]:
    cube = OneOf(tuple(CUBES), CUBE_WORDS)
    cube_or_it = OneOf((*CUBES, IT), CUBE_WORDS | _HELD_WORDS)
    target_word = OneOf((*BINS, *CUBES, TABLE), BIN_WORDS | CUBE_WORDS | TABLE_WORDS)

    @skill()
    def grasp(goal: GoalHandle, object: Annotated[str, cube]) -> Result:  # noqa: A002
        """Pick up a cube and hold it."""
        body.grasp(object, token=goal.token, report=goal.report)
        return body.describe_hand()

    @skill()
    def place(
        goal: GoalHandle,
        object: Annotated[str, cube_or_it] = IT,  # noqa: A002
        target: Annotated[str, target_word] = TABLE,
    ) -> Result:
        """Put a cube, or what is held, into a bin, onto another cube, or on the table."""
        name = None if object == IT else object
        placed = body.place(name, target, token=goal.token, report=goal.report)
        return {**body.describe_hand(), "object": placed}

    @skill(lasting=True)
    def release(goal: GoalHandle) -> Result:
        """Open the hand and let go of whatever it holds."""
        held = body.release(token=goal.token, report=goal.report)
        return {**body.describe_hand(), "released": held}

    return grasp, place, release


def _moving(body: Manipulator) -> tuple[Skill, ...]:
    @skill(check=_check_point)
    def move_to(
        goal: GoalHandle,
        x: Annotated[float, Field(description="metres forward of the arm's base")],
        y: Annotated[float, Field(description="metres to the left of the arm's base")],
        z: Annotated[float, Field(description="metres above the table")],
    ) -> Result:
        """Move the hand to a point, given by its coordinates in metres."""
        body.move_to(x, y, z, token=goal.token, report=goal.report)
        return body.describe_hand()

    @skill()
    def goto_home(goal: GoalHandle) -> Result:
        """Move the arm to its home position, out of the way."""
        body.go_home(token=goal.token, report=goal.report)
        return body.describe_hand()

    @skill(entry="stop_arm")
    def stop(goal: GoalHandle) -> Result:
        """Stop moving at once; what is held stays held."""
        goal.token.check()
        return {"was_moving": body.halt(str(called_off("stop_asked")))}

    return move_to, goto_home, stop


def _check_point(x: float, y: float, z: float) -> None:
    """Refuse a point beyond `FAR_M`; for a nearer one, the arm may offer another point."""
    if max(abs(x), abs(y), abs(z)) > FAR_M:
        raise SkillFailed(because("point_too_far", x=f"{x:g}", y=f"{y:g}", z=f"{z:g}"))


def _telling(body: Manipulator) -> tuple[Skill, ...]:
    @skill(entry="get_pose_of_hand", moves=False)
    def get_pose(goal: GoalHandle) -> Result:
        """Say where the hand is and what it holds."""
        goal.token.check()
        hand = body.describe_hand()
        return {**hand, "empty": hand["held"] is None}

    @skill(moves=False)
    def list_objects(goal: GoalHandle) -> Result:
        """Say which objects there are and where each one is."""
        goal.token.check()
        return body.describe_objects()

    return get_pose, list_objects
