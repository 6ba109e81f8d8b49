"""The arm's tasks, as plain sequences of motions. All block; none needs a lock."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.reason import Reason
from edgevox.core.transforms import rotate
from edgevox.robots.panda import table
from edgevox.robots.panda.arm import FINGERS, OPEN_M
from edgevox.robots.panda.kinematics import READY, HandPose, Joints
from edgevox.robots.panda.motion import BRISK, CAREFUL, Task
from edgevox.robots.panda.planner import (
    NOTHING,
    ArmSegment,
    InTheWay,
    OutOfReach,
    Touch,
    above,
    spoken,
    touch,
)
from edgevox.robots.panda.table import BINS, CUBE_SIZE_M, CUBES, TABLE, Placed
from edgevox.robots.panda.workcell import Workcell

PICK_MOTIONS = 6
PLACE_MOTIONS = 7
_TRAVEL_M = 0.24
_ABOVE_M = 0.10
_TRIES = 3
_MOVED_M = 0.006
_CLEAR_M = 0.003
_HALF_OPEN_M = 0.068
_SETTLE_S = 0.3


def pick(cell: Workcell, task: Task, name: str) -> None:
    """Grasp this cube and lift it. It is looked at again before the hand goes down and closes."""
    for _ in range(_TRIES):
        if _try_pick(cell, task, name):
            return
        task.restart()
    raise SkillFailed(because("slipped", thing=spoken(name)))


def place(cell: Workcell, task: Task, name: str, target: str) -> None:
    """Put the held cube down there, and make sure that it stays."""
    task.phase = f"taking it to the {spoken(target)}"
    touches = _around(name, target)
    _rise(cell, task)
    spot = spot_for(cell, name, target)
    hand, down = _approach(cell, task, _hands_for(cell, name, spot), touches, target)
    task.phase = "putting it down"
    cell.follow(task, down)
    cell.let_go()
    cell.grip(task, _HALF_OPEN_M)
    task.phase = "drawing back"
    cell.move(task, above(hand, hand.z_m + _ABOVE_M), CAREFUL, allowed=touches)
    cell.rest(task, _SETTLE_S)
    there = table.where(name, cell.things(), None)
    if there != target:
        raise SkillFailed(because("not_stayed", thing=spoken(name), place=spoken(there)))


def release(cell: Workcell, task: Task) -> str | None:
    """Open the hand, whatever is below. What it held."""
    task.phase = "opening the hand"
    held = cell.let_go()
    cell.grip(task, OPEN_M)
    cell.rest(task, _SETTLE_S)
    return held


def home(cell: Workcell, task: Task) -> None:
    """Back to the ready position, with whatever it holds."""
    task.phase = "going home"
    go(cell, task, READY)


def go(cell: Workcell, task: Task, end: Joints) -> None:
    """Move to these joints: straight if that is free, else by way of a height where all is free."""
    try:
        cell.swing(task, end, BRISK)
    except InTheWay:
        _rise(cell, task)
        goal = cell.planner.pose_at(end)
        if goal is not None:
            cell.move(task, above(goal, max(goal.z_m, _TRAVEL_M)), BRISK)
        cell.swing(task, end, BRISK)


def check_pick(cell: Workcell, name: str) -> None:
    """Raises `SkillFailed` with the reason why this cube cannot be grasped."""
    things, held = cell.things(), cell.arm.hand.held
    if held == name:
        raise SkillFailed(because("held_already", thing=spoken(name)))
    if held is not None:
        raise SkillFailed(because("hand_full", thing=spoken(held)))
    if table.where(name, things, held) == table.FLOOR:
        raise SkillFailed(because("out_of_reach", thing=spoken(name)))
    upper = table.on_top(name, things)
    if upper is not None:
        raise SkillFailed(because("stands_on", upper=spoken(upper), thing=spoken(name)))


def spot_for(cell: Workcell, name: str, target: str) -> Placed:
    """Return the place for the middle of this cube. Raises `SkillFailed` if there is no room."""
    things, half = cell.things(), CUBE_SIZE_M / 2
    if target == name:
        raise SkillFailed(because("on_itself", thing=spoken(name)))
    if target in CUBES:
        return _spot_on(cell, name, target)
    if target == TABLE:
        spot = table.free_table(name, things, CUBES[name].start)
        floor_m = 0.0
    else:
        spot, floor_m = table.free_spot(name, BINS[target], things), BINS[target].floor_m
    if spot is None:
        raise SkillFailed(because("no_room", place=spoken(target)))
    return Placed(*spot, floor_m + half)


def _spot_on(cell: Workcell, name: str, target: str) -> Placed:
    things = cell.things()
    lower, upper = things[target], table.on_top(target, things)
    if table.where(target, things, None) == table.FLOOR:
        raise SkillFailed(because("fell_off", thing=spoken(target)))
    if upper not in (None, name):
        raise SkillFailed(because("occupied", thing=spoken(target), upper=spoken(upper)))
    return replace(lower, z_m=lower.z_m + CUBE_SIZE_M)


def _try_pick(cell: Workcell, task: Task, name: str) -> bool:
    task.phase = f"reaching for the {spoken(name)}"
    cell.grip(task, OPEN_M)
    _rise(cell, task)
    touches = _around(name)
    hand, down = _approach(cell, task, _hands_at(cell.things()[name]), touches, name)
    if _moved(cell, name, hand):
        return False
    task.phase = f"grasping the {spoken(name)}"
    cell.follow(task, down)
    if not _moved(cell, name, hand):
        cell.grip(task, 0.0)
    if not cell.take(name):
        cell.grip(task, OPEN_M)
        cell.move(task, above(hand, hand.z_m + _ABOVE_M), CAREFUL, allowed=touches)
        return False
    task.phase = f"lifting the {spoken(name)}"
    cell.move(task, above(hand, hand.z_m + _ABOVE_M), CAREFUL, allowed=touches)
    return cell.take(name)


def _approach(
    cell: Workcell, task: Task, poses: Sequence[HandPose], allowed: frozenset[Touch], to: str
) -> tuple[HandPose, ArmSegment]:
    """Go above the first of these poses that can be reached from above; it, and the way down."""
    failure: Reason | None = None
    for hand in poses:
        try:
            across, down = cell.plan(
                (above(hand, hand.z_m + _ABOVE_M), BRISK, NOTHING), (hand, CAREFUL, allowed)
            )
        except OutOfReach:
            failure = failure or because("thing_too_far", thing=spoken(to))
        except InTheWay as error:
            failure = because("not_accessible", thing=spoken(to), why=error.reason)
        else:
            cell.follow(task, across)
            return hand, down
    raise SkillFailed(failure or because("no_further"))


def _rise(cell: Workcell, task: Task) -> None:
    """Up to where nothing is in the way, if the hand is low."""
    pose = cell.planner.pose_at(cell.arm.target)
    if pose is not None and pose.z_m < _TRAVEL_M - 0.01:
        cell.move(task, above(pose, _TRAVEL_M), BRISK)


def _hands_at(cube: Placed) -> list[HandPose]:
    """Poses that grasp a cube that lies so."""
    return [HandPose(cube.x_m, cube.y_m, cube.z_m, yaw) for yaw in _turns(cube.yaw_rad)]


def _hands_for(cell: Workcell, name: str, spot: Placed) -> list[HandPose]:
    """Poses of the hand that bring the cube in it to this spot, square with it."""
    cube, point = cell.things()[name], cell.hand_m()
    pose = cell.planner.pose_at(cell.arm.target)
    hand_yaw = pose.yaw_rad if pose else 0.0
    away_x, away_y, away_z = (np.array([cube.x_m, cube.y_m, cube.z_m]) - point).tolist()
    hands = []
    for yaw in _turns(spot.yaw_rad - (cube.yaw_rad - hand_yaw)):
        x, y = rotate(away_x, away_y, yaw - hand_yaw)
        hands.append(HandPose(spot.x_m - x, spot.y_m - y, spot.z_m + _CLEAR_M - away_z, yaw))
    return hands


def _turns(yaw_rad: float) -> list[float]:
    """The ways to turn the hand that look alike to a cube, the least twisted first."""
    quarter = math.pi / 2
    least = yaw_rad - quarter * round(yaw_rad / quarter)
    return sorted((least, least - quarter, least + quarter), key=abs)


def _moved(cell: Workcell, name: str, hand: HandPose) -> bool:
    """Return whether the cube is not where the hand expects it."""
    return cell.things()[name].away_m(Placed(hand.x_m, hand.y_m, hand.z_m)) > _MOVED_M


def _around(name: str, target: str | None = None) -> frozenset[Touch]:
    """Return the touches that are allowed while this cube is grasped or put down there."""
    pads = {touch(name, finger) for finger in FINGERS}
    return frozenset(pads | ({touch(name, target)} if target else set()))
