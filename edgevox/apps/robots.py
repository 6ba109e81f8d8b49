"""The robots that `edgevox-agent` knows by name, each built only when it is asked for."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from edgevox.agent.agents import Agent
from edgevox.agent.skills import SkillSet
from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.robots.capabilities import Body

INSTRUCTIONS = (
    "You are EdgeVox, the voice of a small robot in a home. Be friendly and brief: one or two short"
    " sentences. Only promise what your skills can do."
)

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

Build = Callable[[Settings, float | None], Body]
"""Makes a body that is not yet started, in a world that runs at that multiple of real time; with
None as fast as it can, with 0 only as far as `advance` asks."""


@dataclass(frozen=True)
class Robot:
    """One robot: what it is, how to build it, what the language model is told of itself.

    `models` are the ids of edgevox-models that it needs as it comes; `build` locates them.
    """

    about: str
    build: Build
    instructions: str = INSTRUCTIONS
    models: tuple[str, ...] = ()


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


ROBOTS: Mapping[str, Robot] = {
    "robot-apartment": Robot("a mobile robot in a simulated four-room apartment", _apartment),
    "robot-irsim": Robot("the same robot in the same apartment, simulated with IR-SIM", _irsim),
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
    "robot-external": Robot("any ROS 2 robot, over its odom, cmd_vel and goal_pose", _external),
}
"""All of them, in the order in which they are listed."""


def build_body(name: str, settings: Settings, speed: float | None = 1.0) -> Body:
    """The body of this robot, not yet started. Raises `EdgeVoxError` with the reason."""
    return ROBOTS[name].build(settings, speed)


def build_agents(body: Body | None) -> Sequence[Agent]:
    """Who talks: for a body one agent that has all its skills, else one that has none."""
    if body is None:
        return (Agent("edgevox", TALK_INSTRUCTIONS),)
    return (Agent(body.name, ROBOTS[body.name].instructions, SkillSet(body.skills)),)
