"""The parts of `robot_state`, JSON-ready."""

from typing import Any

from edgevox.robots.engine import MotionState
from edgevox.robots.navigation_motion import NavigationMotion


def describe_motion(motion: MotionState) -> dict[str, Any]:
    """Pose (metres, radians, map frame) and velocity (m/s, rad/s, body frame)."""
    pose, twist = motion.pose, motion.twist
    return {
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
    }


def describe_goal(drive: NavigationMotion | None) -> dict[str, float] | None:
    """Where a drive goes to, how far it is (0 to 1), and the metres that are left; None without."""
    if drive is None:
        return None
    progress = drive.progress()
    return {
        "x": round(drive.goal[0], 3),
        "y": round(drive.goal[1], 3),
        "progress": round(progress.part, 3),
        "distance": round(progress.left, 3),
    }
