"""What an arm can tell of the cubes and bins on its table, beside what any body tells."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Protocol

from edgevox.agent.skills import GoalHandle, OneOf, Result, Skill, skill
from edgevox.agent.skills.choices import NewName
from edgevox.robots.panda.layout import BINS, CUBES, TABLE
from edgevox.robots.panda.skills import BIN_WORDS, CUBE_WORDS, TABLE_WORDS
from edgevox.robots.panda.things import HAND

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
