"""The simulated robots that EdgeVox brings; pyproject.toml names them, as any package's would.

Each imports its simulator and looks for its models when its body is built, not before.
"""

from pathlib import Path

from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.robots.capabilities import Body
from edgevox.robots.plugin import Robot

ARM_INSTRUCTIONS = (
    "You are EdgeVox, the voice of a robot arm that stands at a table with cubes and bins. You"
    " cannot drive or walk. Be friendly and brief: one or two short sentences. Only promise what"
    " your skills can do."
)
HUMANOID_INSTRUCTIONS = (
    "You are EdgeVox, the voice of a humanoid robot that walks. You cannot pick anything up. Be"
    " friendly and brief: one or two short sentences. Only promise what your skills can do."
)

PANDA_MODEL, G1, G1_POLICY, H1 = "franka-panda", "unitree-g1", "g1-walking-policy", "unitree-h1"
"""Models of robots, by their ids in edgevox-models."""


def _apartment(settings: Settings, speed: float | None) -> Body:
    from edgevox.robots.flat.apartment import ApartmentRobot
    from edgevox.robots.world.load import load_world

    return ApartmentRobot(load_world(settings.world, seed=settings.seed), speed=speed)


def _irsim(settings: Settings, speed: float | None) -> Body:
    from edgevox.robots.flat.irsim import IrsimRobot
    from edgevox.robots.world.load import load_world

    return IrsimRobot(load_world(settings.world, seed=settings.seed), speed=speed)


def _panda(settings: Settings, speed: float | None) -> Body:
    path = locate(PANDA_MODEL)
    from edgevox.robots.panda.robot import PandaRobot
    from edgevox.robots.panda.workcell import Workcell

    return PandaRobot(Workcell(path, seed=settings.seed, speed=speed))


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


_FLAT = frozenset({"world", "seed"})

APARTMENT = Robot("a mobile robot in a simulated four-room apartment", _apartment, reads=_FLAT)
IRSIM = Robot("the same robot in the same apartment, simulated with IR-SIM", _irsim, reads=_FLAT)
PANDA = Robot(
    "a Franka Panda arm at a table with cubes and bins, simulated with MuJoCo",
    _panda,
    ARM_INSTRUCTIONS,
    (PANDA_MODEL,),
    reads=frozenset({"seed"}),
)
HUMANOID = Robot(
    "a humanoid on its feet, simulated with MuJoCo",
    _humanoid,
    HUMANOID_INSTRUCTIONS,
    (G1, G1_POLICY),
    reads=frozenset({"mjcf", "model_source", "seed"}),
)
