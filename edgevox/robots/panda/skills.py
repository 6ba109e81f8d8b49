"""The skills of an arm that moves cubes about a table, and what it can tell of them."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Protocol

from pydantic import Field

from edgevox.agent.skills import GoalHandle, OneOf, Result, Skill, SkillFailed, skill
from edgevox.agent.skills.skill import NewName
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import CancelToken
from edgevox.robots.capabilities import Body, Report
from edgevox.robots.panda.table import BINS, CUBES, FAR_M, HAND, TABLE

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
    @skill(check=_check_point, undoable=True)
    def move_to(
        goal: GoalHandle,
        x: Annotated[float, Field(description="metres forward of the arm's base")],
        y: Annotated[float, Field(description="metres to the left of the arm's base")],
        z: Annotated[float, Field(description="metres above the table")],
    ) -> Result:
        """Move the hand to a point, given by its coordinates in metres."""
        body.move_to(x, y, z, token=goal.token, report=goal.report)
        return body.describe_hand()

    @skill(undoable=True)
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


_CUBE = OneOf(tuple(CUBES), CUBE_WORDS)
_SPOT = OneOf((*BINS, TABLE), BIN_WORDS | TABLE_WORDS)


class SeesThings(Protocol):
    """The body that these facts are about."""

    def describe_hand(self) -> dict[str, Any]: ...

    def describe_objects(self) -> dict[str, Any]: ...


def table_facts(body: SeesThings) -> tuple[Skill, ...]:
    """`where_is`, `is_it_there`, `what_is_there`, `what_is_in_bins`, `how_far_is_thing`, ..."""
    return (*_of_one(body), *_of_all(body))


def _of_one(body: SeesThings) -> tuple[Skill, ...]:
    @skill(moves=False)
    def where_is(goal: GoalHandle, object: Annotated[str, _CUBE]) -> Result:  # noqa: A002
        """Say where a cube is."""
        goal.token.check()
        return {"object": object, "place": _things(body)[object]["on"]}

    @skill(moves=False)
    def is_it_there(
        goal: GoalHandle,
        object: Annotated[str, _CUBE],  # noqa: A002
        target: Annotated[str, _SPOT],
    ) -> Result:
        """Say whether a cube is in a bin or on the table."""
        goal.token.check()
        place = _things(body)[object]["on"]
        yes = place == target
        return {"object": object, "place": place, "yes": yes, "no": not yes}

    @skill(moves=False)
    def how_far_is_thing(goal: GoalHandle, object: Annotated[str, _CUBE]) -> Result:  # noqa: A002
        """Say how far a cube is from the hand."""
        goal.token.check()
        held = _things(body)[object]["on"] == HAND
        return {"object": object, "held": held, "distance": None if held else _far_m(body)[object]}

    return where_is, is_it_there, how_far_is_thing


def _of_all(body: SeesThings) -> tuple[Skill, ...]:
    @skill(moves=False)
    def what_is_there(goal: GoalHandle, target: Annotated[str, _SPOT]) -> Result:
        """Say what is in a bin or on the table."""
        goal.token.check()
        return {"target": target, **_counted(_in(body, target))}

    @skill(moves=False)
    def what_is_in_bins(goal: GoalHandle) -> Result:
        """Say what is in the bins."""
        goal.token.check()
        return _counted(_in(body, *BINS))

    @skill(moves=False)
    def nearest_thing(goal: GoalHandle) -> Result:
        """Say which cube is nearest to the hand."""
        goal.token.check()
        far_m = _far_m(body)
        nearest = min(far_m, key=far_m.__getitem__, default=None)
        return {"object": nearest, "distance": far_m[nearest]} if nearest else {}

    @skill(moves=False)
    def which_things(goal: GoalHandle) -> Result:
        """Say which cubes there are, by their colours."""
        goal.token.check()
        return {"names": list(_things(body))}

    @skill(moves=False)
    def is_there_one(goal: GoalHandle, what: Annotated[str, NewName()]) -> Result:
        """Say that there is no such thing, and what there is."""
        goal.token.check()
        return {"what": what, "objects": _things(body)}

    return what_is_there, what_is_in_bins, nearest_thing, which_things, is_there_one


def _things(body: SeesThings) -> Mapping[str, Mapping[str, Any]]:
    things: Mapping[str, Mapping[str, Any]] = body.describe_objects()["objects"]
    return things


def _in(body: SeesThings, *targets: str) -> Mapping[str, Mapping[str, Any]]:
    return {name: one for name, one in _things(body).items() if one["on"] in targets}


def _counted(things: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    return {"objects": things, "count": len(things) if len(things) > 1 else None}


def _far_m(body: SeesThings) -> dict[str, float]:
    """How far the cubes that it does not hold are from the hand, in metres."""
    hand = body.describe_hand()
    middle = [hand[axis] for axis in "xyz"]
    return {
        name: math.dist(middle, [one[axis] for axis in "xyz"])
        for name, one in _things(body).items()
        if one["on"] != HAND
    }
