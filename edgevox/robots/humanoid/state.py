"""The humanoid's part of `robot_state`, JSON-ready."""

from typing import Any

from edgevox.robots.humanoid.environment import MujocoHumanoidEnvironment
from edgevox.robots.humanoid.manoeuvre import Manoeuvre
from edgevox.robots.humanoid.pilot import Pilot


def describe(environment: MujocoHumanoidEnvironment, pilot: Pilot) -> dict[str, Any]:
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
        "activity": _activity(environment, pilot),
        "fallen": environment.fallen,
        "goal": _goal(pilot.manoeuvre),
    }


def _activity(environment: MujocoHumanoidEnvironment, pilot: Pilot) -> str:
    if environment.fallen:
        return "fallen"
    return "walking" if pilot.walking else "standing"


def _goal(manoeuvre: Manoeuvre | None) -> dict[str, Any] | None:
    """What it is about, how far that is (0 to 1), and the metres or degrees that are left."""
    if manoeuvre is None:
        return None
    progress = manoeuvre.progress()
    kind = {"m": "walk", "deg": "turn"}.get(progress.unit, "stand")
    return {"kind": kind, "progress": round(progress.part, 3), "left": round(progress.left, 3)}
