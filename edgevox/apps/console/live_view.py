"""What of a body moves, as a page draws it 15 times a second: exactly what the body has.

Metres and radians, map frame. What cannot be known at the moment is None.
"""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np

from edgevox.agent.skills import SkillFailed
from edgevox.apps.console.map_scene import InWorld, Label, path, pushed
from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import Body, HasBattery, HasLidar, HasPose, LidarScan

MOST_POINTS = 360
"""So many points of a lidar are shown; of more beams every second or third."""
WIDE_OPEN_M = 0.08
"""How wide the arm's hand can be opened."""


@runtime_checkable
class HasJoints(Protocol):
    """Turns in joints."""

    def joints(self) -> Mapping[str, tuple[float, float, float]]:
        """The angle of each joint and its two limits, radians."""


def live(body: Body, label: Label) -> dict[str, Any]:
    """How the body is now, JSON-ready."""
    state = body.state()
    pose = _pose(body)
    found: dict[str, Any] = {"time": state.get("time"), "goal": state.get("goal")}
    if isinstance(body, HasPose):
        found |= {"pose": _as_json(pose), "velocity": state.get("velocity") if pose else None}
    if isinstance(body, HasLidar) and pose:
        found["lidar"] = _lidar(body, pose)
    if isinstance(body, InWorld):
        found |= {"path": path(body), "furniture": pushed(body, label)}
    if isinstance(body, HasBattery):
        found["battery"] = {"level": round(body.battery(), 4)}
    if isinstance(body, HasJoints):
        found["joints"] = [
            {"name": name, "value": round(angle, 4), "lower": low, "upper": high}
            for name, (angle, low, high) in body.joints().items()
        ]
    return found | _hand(state, label)


def _hand(state: Mapping[str, Any], label: Label) -> dict[str, Any]:
    """What a hand holds and what lies before it, of a body whose state says so."""
    if "gripper_width" not in state:
        return {}
    held = state["held"]
    things = [
        {"name": name, "label": label(name), "held": name == held, **point}
        for name, point in state["objects"].items()
    ]
    width = min(state["gripper_width"] / WIDE_OPEN_M, 1.0)
    return {"hand": {"open": round(width, 3), "holding": held}, "things": things}


def _pose(body: Body) -> Pose2D | None:
    if not isinstance(body, HasPose):
        return None
    try:
        return body.pose()
    except SkillFailed:  # nothing is heard of it
        return None


def _as_json(pose: Pose2D | None) -> dict[str, float] | None:
    if pose is None:
        return None
    return {"x": round(pose.x_m, 3), "y": round(pose.y_m, 3), "yaw": round(pose.yaw_rad, 4)}


def _lidar(body: HasLidar, pose: Pose2D) -> list[float]:
    """Where its beams end that hit something, x and y in turn."""
    try:
        scan = body.scan()
    except SkillFailed:  # such as a sensor that is silent
        return []
    return _ends(scan, pose)


def _ends(scan: LidarScan, pose: Pose2D) -> list[float]:
    ranges = np.asarray(scan.ranges_m, dtype=np.float64)
    hits = np.isfinite(ranges)
    ends = scan.ends(np.where(hits, ranges, 0.0))[hits]
    ends = ends[:: max(1, -(-len(ends) // MOST_POINTS))]
    return [round(one, 2) for x_m, y_m in ends.tolist() for one in to_map((x_m, y_m), pose)]
