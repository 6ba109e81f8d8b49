"""The parts of `robot_state`, JSON-ready."""

from typing import Any

from edgevox.robots.drive import Progress
from edgevox.robots.engine import Motion


def describe_motion(motion: Motion) -> dict[str, Any]:
    """Pose (metres, radians, map frame) and velocity (m/s, rad/s, body frame)."""
    pose, twist = motion.pose, motion.twist
    return {
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
    }


def describe_goal(progress: Progress | None) -> dict[str, float] | None:
    """Where a drive goes to, how far it is (0 to 1), and the metres that are left; None without."""
    if progress is None:
        return None
    return {
        "x": round(progress.goal[0], 3),
        "y": round(progress.goal[1], 3),
        "progress": round(progress.progress, 3),
        "distance": round(progress.distance_m, 3),
    }
