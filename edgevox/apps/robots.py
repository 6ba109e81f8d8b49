"""The robots that `edgevox-agent` knows by name, each built only when it is asked for."""

from collections.abc import Callable, Mapping, Sequence

from edgevox.agent.agents import Agent
from edgevox.agent.skills import SkillSet
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body

INSTRUCTIONS = (
    "You are EdgeVox, the voice of a small robot in a home. Be friendly and brief: one or two short"
    " sentences. Only promise what your skills can do."
)


def _apartment(settings: Settings) -> Body:
    from edgevox.robots.apartment import ApartmentRobot
    from edgevox.robots.world import load_world

    return ApartmentRobot(load_world(settings.world))


def _external(settings: Settings) -> Body:
    from edgevox.ros2.external import build_external

    return build_external(
        settings.external_namespace,
        settings.locations,
        max_linear_m_s=settings.max_linear,
        max_angular_rad_s=settings.max_angular,
    )


ROBOTS: Mapping[str, tuple[str, Callable[[Settings], Body]]] = {
    "robot-apartment": ("a mobile robot in a simulated four-room apartment", _apartment),
    "robot-external": ("any ROS 2 robot, over its odom, cmd_vel and goal_pose", _external),
}
"""What each robot is, and how to build it."""


def build_body(name: str, settings: Settings) -> Body:
    """The body of this robot, not yet started."""
    return ROBOTS[name][1](settings)


def build_agents(body: Body) -> Sequence[Agent]:
    """Who talks for this body: one agent that has all its skills."""
    return (Agent(body.name, INSTRUCTIONS, SkillSet(body.skills)),)
