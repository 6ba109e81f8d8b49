"""`robot-humanoid`: a robot on two legs in MuJoCo, in physics with a walking policy or without one.

Imports core, agent.skills, agent.text and the robots' shared parts. What outsiders need is
named here.
"""

import edgevox.robots.mujoco  # noqa: F401, I001 - first: mujoco is imported by it, safely

from edgevox.robots.humanoid.environment import MujocoHumanoidEnvironment
from edgevox.robots.humanoid.walking_policy import OnnxWalkingPolicy
from edgevox.robots.humanoid.walking_policy import (
    FunctionPolicy,
    Observation,
    WalkingCommand,
    WalkingPlan,
    WalkingPolicy,
)
from edgevox.robots.humanoid.robot import HumanoidRobot

__all__ = [
    "FunctionPolicy",
    "HumanoidRobot",
    "MujocoHumanoidEnvironment",
    "Observation",
    "OnnxWalkingPolicy",
    "WalkingCommand",
    "WalkingPlan",
    "WalkingPolicy",
]
