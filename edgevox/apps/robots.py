"""The robots that `edgevox-agent` knows by name, each built only when it is asked for."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from edgevox.agent.agents import Agent
from edgevox.agent.names import check_skills
from edgevox.agent.skills import SkillSet
from edgevox.apps.robot import INSTRUCTIONS, Robot, installed_robots
from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.robots.capabilities import Body

ARM_INSTRUCTIONS = (
    "You are EdgeVox, the voice of a robot arm that stands at a table with cubes and bins. You"
    " cannot drive or walk. Be friendly and brief: one or two short sentences. Only promise what"
    " your skills can do."
)
HUMANOID_INSTRUCTIONS = (
    "You are EdgeVox, the voice of a humanoid robot that walks. You cannot pick anything up. Be"
    " friendly and brief: one or two short sentences. Only promise what your skills can do."
)
TALK_INSTRUCTIONS = (
    "You are EdgeVox, a voice agent that runs offline and has no robot at the moment. Be friendly"
    " and brief: one or two short sentences."
)

PANDA, G1, G1_POLICY, H1 = "franka-panda", "unitree-g1", "g1-walking-policy", "unitree-h1"
"""Models of robots, by their ids in edgevox-models."""


def _apartment(settings: Settings, speed: float | None) -> Body:
    from edgevox.robots.apartment import ApartmentRobot
    from edgevox.robots.world import load_world

    return ApartmentRobot(load_world(settings.world, seed=settings.seed), speed=speed)


def _irsim(settings: Settings, speed: float | None) -> Body:
    from edgevox.robots.irsim import IrsimRobot
    from edgevox.robots.world import load_world

    return IrsimRobot(load_world(settings.world, seed=settings.seed), speed=speed)


def _panda(settings: Settings, speed: float | None) -> Body:
    path = locate(PANDA)
    from edgevox.robots.panda.robot import PandaRobot

    return PandaRobot(path, seed=settings.seed, speed=speed)


def _humanoid(settings: Settings, speed: float | None) -> Body:
    mjcf, policy = _humanoid_files(settings)
    from edgevox.robots.humanoid import (
        HumanoidRobot,
        MujocoHumanoidEnvironment,
        OnnxWalkingPolicy,
    )

    walks = OnnxWalkingPolicy(policy) if policy else None
    return HumanoidRobot(MujocoHumanoidEnvironment(mjcf, walks, seed=settings.seed), speed=speed)


def _humanoid_files(settings: Settings) -> tuple[Path, Path | None]:
    """The robot, and the policy that it walks by; without one its gait is procedural."""
    if settings.mjcf:
        return settings.mjcf, None
    if settings.model_source == "unitree_h1":
        return locate(H1), None
    return locate(G1), locate(G1_POLICY)


def _external(settings: Settings, _speed: float | None) -> Body:
    from edgevox.ros2.external import build_external

    return build_external(
        settings.external_namespace,
        settings.locations,
        max_linear_m_s=settings.max_linear,
        max_angular_rad_s=settings.max_angular,
    )


_OURS: Mapping[str, Robot] = {
    "robot-apartment": Robot(
        "a mobile robot in a simulated four-room apartment", _apartment, INSTRUCTIONS
    ),
    "robot-irsim": Robot(
        "the same robot in the same apartment, simulated with IR-SIM", _irsim, INSTRUCTIONS
    ),
    "robot-panda": Robot(
        "a Franka Panda arm at a table with cubes and bins, simulated with MuJoCo",
        _panda,
        ARM_INSTRUCTIONS,
        (PANDA,),
    ),
    "robot-humanoid": Robot(
        "a humanoid on its feet, simulated with MuJoCo",
        _humanoid,
        HUMANOID_INSTRUCTIONS,
        (G1, G1_POLICY),
    ),
    "robot-external": Robot(
        "any ROS 2 robot, over its odom, cmd_vel and goal_pose", _external, INSTRUCTIONS
    ),
}


ROBOTS: Mapping[str, Robot] = {**_OURS, **installed_robots(besides=_OURS)}
"""All of them, in the order in which they are listed."""


def build_body(name: str, settings: Settings, speed: float | None = 1.0) -> Body:
    """The body of this robot, not yet started. Raises `EdgeVoxError` with the reason."""
    return ROBOTS[name].build(settings, speed)


def build_agents(body: Body | None) -> Sequence[Agent]:
    """Who talks: for a body one agent that has all its skills, else one that has none.

    Raises `InvalidValue` for a skill, or a word of one, that people need for something else.
    """
    if body is None:
        return (Agent("edgevox", TALK_INSTRUCTIONS),)
    check_skills(body.skills)
    return (Agent(body.name, ROBOTS[body.name].instructions, SkillSet(body.skills)),)
