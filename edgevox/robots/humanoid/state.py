"""The humanoid's part of `robot_state`, JSON-ready."""

from typing import Any

from edgevox.robots.humanoid.motion_primitive import MotionPrimitive
from edgevox.robots.humanoid.mujoco_environment import MujocoHumanoidEnvironment


def describe(
    environment: MujocoHumanoidEnvironment, motion: MotionPrimitive | None, *, walking: bool
) -> dict[str, Any]:
    """Pose and height of the pelvis (metres, radians, map frame), velocity (m/s, rad/s), and more.

    `simulation` is "physics", or "kinematic" for a robot that is moved without any forces; `gait`
    says what decides its steps, `activity` what it does.
    """
    pose, twist = environment.pose, environment.velocity
    return {
        "simulation": environment.simulation,
        "gait": environment.gait,
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "height": round(environment.height_m, 4),
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
        "activity": "fallen" if environment.fallen else "walking" if walking else "standing",
        "fallen": environment.fallen,
        "goal": _goal(motion),
    }


def _goal(motion: MotionPrimitive | None) -> dict[str, Any] | None:
    """What it is about, how far that is (0 to 1), and the metres or degrees that are left."""
    if motion is None:
        return None
    progress = motion.progress()
    kind = {"m": "walk", "deg": "turn"}.get(progress.unit, "stand")
    return {"kind": kind, "progress": round(progress.part, 3), "left": round(progress.left, 3)}
