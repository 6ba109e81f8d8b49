"""What any body can tell of itself and its world, from what it can do.

A fact answers a question: a skill that moves nothing. Its result has what is known now; the table
`facts` of each language's file has the templates that ask for it and the sentences that tell it, of
which the last says that it is not known. A body adds its own with `TellsFacts`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from edgevox.agent.known import Known, WayLeft, about_s, no_place
from edgevox.agent.skills import Call, GoalHandle, OneOf, Result, Skill, SkillFailed, skill
from edgevox.agent.skills.skill import TO_POINT
from edgevox.core.reason import NO_REASON
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import (
    Body,
    HasBattery,
    HasEndEffector,
    HasLidar,
    HasPlaces,
    HasPose,
    KnowsPowerDraw,
    LidarScan,
    MayBeUnheard,
    MeasuresWays,
    RemembersPlaces,
    TakesVelocity,
    TellsConditions,
    TellsFacts,
    TellsMotions,
    TellsStalls,
    charge_of,
)
from edgevox.robots.pictures import has_camera, no_camera

_STALLED_S = 1.0
"""A world that has stood still for this long may hold the lock that guards its battery."""

_NO_PLACES = OneOf(())
_NEAR_M = 0.5
"""Nearer than this to the point of a place, a body is there."""
_STILL_M_S, _STILL_RAD_S = 0.02, 0.05
_LANE_M = 0.3
"""Half the width of the lane ahead that a body needs; measured from its middle."""
_SIDES = ("in_front_of_me", "to_my_left", "behind_me", "to_my_right")


def facts_of(body: Body) -> tuple[Skill, ...]:
    """The facts of this body, its own first, and last those that any words ask for."""
    own = body.facts if isinstance(body, TellsFacts) else ()
    facts = [*own, *_places(body), *_motion(body), *_senses(body)]
    if not isinstance(body, HasBattery):
        facts.append(_no_battery())
    if not has_camera(body):
        facts.append(no_camera())
    return tuple(sorted(facts, key=lambda one: bool(one.new_names)))


def known_of(body: Body) -> Known:
    """What this body knows, for a conversation and its programs."""
    return Known(
        facts=facts_of(body),
        pose=body.pose if isinstance(body, HasPose) else None,
        place_at=body.place_at if isinstance(body, HasPlaces) else no_place,
        way_left=lambda: _way_left(body),
        way_back=lambda: _way_back(body),
        battery=(lambda: _charge(body)) if isinstance(body, HasBattery) else None,
        conditions=body.conditions if isinstance(body, TellsConditions) else {},
        unheard=lambda: body.unheard if isinstance(body, MayBeUnheard) else NO_REASON,
    )


def battery_skill(body: HasBattery) -> Skill:
    """Make the skill that tells the charge.

    Its sentence is `[skills.battery] done` of `core/languages/*.toml`, by `Phrasebook.report`.
    """

    @skill(moves=False)
    def battery(goal: GoalHandle) -> Result:
        """Say how full the battery is."""
        goal.token.check()
        charge = body.battery()
        result = {"charge": round(charge, 4), "percent": round(100 * charge)}
        lasts_s = body.battery_lasts_s() if isinstance(body, KnowsPowerDraw) else math.inf
        return {**result, "lasts_s": round(lasts_s)} if math.isfinite(lasts_s) else result

    return battery


def _charge(body: Body) -> float | None:
    stalled_s = body.stalled_s if isinstance(body, TellsStalls) else 0.0
    return charge_of(body) if stalled_s < _STALLED_S else None


def _way_back(body: Body) -> Call | None:
    """Return the call that drives to the present point; None if the body cannot drive to points."""
    skills = {one.name for one in body.skills}
    if not isinstance(body, HasPose) or TO_POINT not in skills:
        return None
    pose = body.pose()
    return Call(TO_POINT, {"x": round(pose.x_m, 2), "y": round(pose.y_m, 2)})


def _way_left(body: Body) -> WayLeft | None:
    """The rest of the way, from the goal in the body's state."""
    goal = body.state().get("goal") or {}
    left = goal.get("left") if goal.get("kind") == "walk" else goal.get("distance")
    if not isinstance(left, int | float):
        return None
    metres = float(left)
    speed_m_s = body.max_linear_m_s if isinstance(body, TakesVelocity) else 0.0
    return WayLeft(metres, metres / speed_m_s if speed_m_s else None)


@dataclass(frozen=True, slots=True)
class _KnownPlaces:
    """The places that a body knows by name, and where it is."""

    body: Body
    choices: OneOf

    def names(self) -> tuple[str, ...]:
        return self.choices.words

    def point(self, name: str) -> tuple[float, float] | None:
        """Metres, in the frame of its pose; None for a place that was just forgotten."""
        if isinstance(self.body, HasPlaces) and name in self.body.places:
            return self.body.places[name]
        if not isinstance(self.body, RemembersPlaces):
            return None
        learned = self.body.place_memory.find(name)
        return (learned.x, learned.y) if learned else None

    def pose(self) -> Pose2D | None:
        """None while the body does not know where it is."""
        try:
            return self.body.pose() if isinstance(self.body, HasPose) else None
        except SkillFailed:
            return None

    def here(self) -> str | None:
        """The place that the body is in."""
        pose = self.pose()
        if pose is None or not isinstance(self.body, HasPlaces):
            return None
        near = [name for name in self.names() if self.straight_m(name, pose) < _NEAR_M]
        return self.body.place_at(pose.x_m, pose.y_m) or next(iter(near), None)

    def is_at(self, name: str) -> bool:
        """True if the body is in this place."""
        pose = self.pose()
        return name == self.here() or (pose is not None and self.straight_m(name, pose) < _NEAR_M)

    def straight_m(self, name: str, pose: Pose2D) -> float:
        point = self.point(name)
        return math.dist((pose.x_m, pose.y_m), point) if point else math.inf

    def way_m(self, name: str) -> float | None:
        """The length of the way there; None where no way leads."""
        point = self.point(name)
        if point is None or not isinstance(self.body, MeasuresWays):
            return None
        try:
            return self.body.way_m(*point)
        except SkillFailed:
            return None


def _known_places(body: Body) -> OneOf:
    """The words for places, as the skill that drives there knows them."""
    goes = (one for one in body.skills if one.name == "navigate_to")
    return next((choices for one in goes for choices in one.choices.values()), _NO_PLACES)


def _places(body: Body) -> Sequence[Skill]:
    choices = _known_places(body)
    known = _KnownPlaces(body, choices)

    @skill(moves=False)
    def how_far(goal: GoalHandle, room: Annotated[str, choices]) -> Result:
        """Say how far a place is, and how long the way there takes."""
        goal.token.check()
        pose = known.pose()
        if pose is None or known.point(room) is None:
            return {"room": room}
        if known.is_at(room):
            return {"room": room, "there": True}
        if not isinstance(body, MeasuresWays):
            return {"room": room, "straight": known.straight_m(room, pose)}
        way_m = known.way_m(room)
        if way_m is None:
            return {"room": room, "no_way": True}
        speed_m_s = body.max_linear_m_s if isinstance(body, TakesVelocity) else 0.0
        takes = {"takes_s": about_s(way_m / speed_m_s)} if speed_m_s else {}
        return {"room": room, "distance": way_m, **takes}

    @skill(moves=False)
    def which_way(goal: GoalHandle, room: Annotated[str, choices]) -> Result:
        """Say in which direction a place lies."""
        goal.token.check()
        pose, point = known.pose(), known.point(room)
        if pose is None or point is None:
            return {"room": room}
        if known.is_at(room):
            return {"room": room, "there": True}
        turn = math.atan2(point[1] - pose.y_m, point[0] - pose.x_m) - pose.yaw_rad
        return {"room": room, "straight": known.straight_m(room, pose), "side": _side(turn)}

    @skill(moves=False)
    def nearest_place(goal: GoalHandle) -> Result:
        """Say which place is nearest, and which is farthest."""
        goal.token.check()
        pose, here = known.pose(), known.here()
        others = [name for name in known.names() if not known.is_at(name)]
        if pose is None or not others:
            return {}
        lengths = {name: known.way_m(name) or math.inf for name in others}
        if all(math.isinf(one) for one in lengths.values()):
            lengths = {name: known.straight_m(name, pose) for name in others}
        nearest, farthest = (pick(others, key=lengths.__getitem__) for pick in (min, max))
        told = {"here": here, "room": nearest, "distance": lengths[nearest]}
        if farthest == nearest or math.isinf(lengths[farthest]):
            return told
        return {**told, "farthest": farthest, "farthest_m": lengths[farthest]}

    @skill(moves=False)
    def which_places(goal: GoalHandle) -> Result:
        """Say which places there are, and how many."""
        goal.token.check()
        names = known.names()
        return {"names": list(names), "count": len(names)}

    @skill(moves=False)
    def are_you_in(goal: GoalHandle, room: Annotated[str, choices]) -> Result:
        """Say whether the robot is in a place."""
        goal.token.check()
        if known.pose() is None:
            return {}
        there = known.is_at(room)
        here = None if there else known.here()
        return {"room": room, "yes": there, "no": not there, "here": here}

    @skill(moves=False)
    def what_is_in_room(goal: GoalHandle, room: Annotated[str, choices]) -> Result:
        """Say that nobody told the robot what is in a place."""
        goal.token.check()
        return {"room": room}

    of_places = (how_far, which_way, are_you_in, what_is_in_room) if choices.words else ()
    return (*of_places, nearest_place, which_places)


def _motion(body: Body) -> Sequence[Skill]:
    @skill(moves=False)
    def how_fast(goal: GoalHandle) -> Result:
        """Say whether and how fast the robot moves."""
        goal.token.check()
        if not isinstance(body, HasPose):
            moving = isinstance(body, TellsMotions) and body.in_motion
            return {"moving": moving, "still": not moving} if isinstance(body, TellsMotions) else {}
        twist = body.velocity()
        if abs(twist.linear_m_s) > _STILL_M_S:
            return {"speed": abs(twist.linear_m_s)}
        turning = abs(twist.angular_rad_s) > _STILL_RAD_S
        return {"turning": turning, "still": not turning}

    @skill(moves=False)
    def top_speed(goal: GoalHandle) -> Result:
        """Say how fast the robot can be."""
        goal.token.check()
        return {"limit": body.max_linear_m_s} if isinstance(body, TakesVelocity) else {}

    @skill(moves=False)
    def compass(goal: GoalHandle) -> Result:
        """Say that the robot has no compass, also to one who asks it to face north."""
        goal.token.check()
        return {}

    return how_fast, top_speed, compass


def _senses(body: Body) -> Sequence[Skill]:
    @skill(moves=False)
    def what_is_ahead(goal: GoalHandle) -> Result:
        """Say how far it is to the next thing ahead."""
        goal.token.check()
        return _ahead(body.scan()) if isinstance(body, HasLidar) else {}

    @skill(moves=False)
    def what_is_around(goal: GoalHandle) -> Result:
        """Say how far the nearest thing is, and on which side."""
        goal.token.check()
        return _around(body.scan()) if isinstance(body, HasLidar) else {}

    @skill(moves=False)
    def what_do_you_see(goal: GoalHandle) -> Result:
        """Say with what the robot perceives its world."""
        goal.token.check()
        camera = has_camera(body)
        lidar = isinstance(body, HasLidar)
        return {
            "camera": camera and not lidar,
            "lidar": lidar and not camera,
            "both": camera and lidar,
        }

    @skill(moves=False)
    def what_do_you_hold(goal: GoalHandle) -> Result:
        """Say that the robot has no hand to hold anything with."""
        goal.token.check()
        return {}

    seen = (what_is_ahead, what_is_around, what_do_you_see)
    return seen if isinstance(body, HasEndEffector) else (*seen, what_do_you_hold)


def _no_battery() -> Skill:
    @skill(moves=False)
    def battery(goal: GoalHandle) -> Result:
        """Say that the robot has no battery."""
        goal.token.check()
        return {}

    return battery


def _ahead(scan: LidarScan) -> Mapping[str, float]:
    """The distance of the next thing in the lane ahead, or how far that is free."""
    ends = scan.ends(np.where(np.isfinite(scan.ranges_m), scan.ranges_m, scan.range_max_m))
    hits = np.isfinite(scan.ranges_m) & (ends[:, 0] > 0.0) & (np.abs(ends[:, 1]) < _LANE_M)
    if not hits.any():
        return {"free": float(scan.range_max_m)}
    return {"distance": float(ends[hits, 0].min())}


def _around(scan: LidarScan) -> Mapping[str, object]:
    if not np.isfinite(scan.ranges_m).any():
        return {"free": float(scan.range_max_m)}
    nearest = int(np.where(np.isfinite(scan.ranges_m), scan.ranges_m, np.inf).argmin())
    x_m, y_m = scan.ends(scan.ranges_m)[nearest]
    return {"distance": math.hypot(x_m, y_m), "side": _side(math.atan2(y_m, x_m))}


def _side(turn_rad: float) -> str:
    """The side on which a direction lies, counter-clockwise from the heading."""
    return _SIDES[round(turn_rad / (math.pi / 2)) % len(_SIDES)]
