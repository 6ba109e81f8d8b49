"""A humanoid on a wide floor in MuJoCo, with its walker: its MJCF file, checked, on a lit grid.

`eased` lets speeds rise evenly and fall at once: a robot must not be torn off its feet.
"""

from pathlib import Path
from typing import Literal

import mujoco
import numpy as np

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import open_file
from edgevox.core.transforms import Pose2D, compose, lift, pitch
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid.walker import Walker, WalkerLimits
from edgevox.robots.humanoid.walkers import KinematicWalker, PhysicsWalker, fit_servos
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand, WalkingPolicy
from edgevox.robots.mujoco.renderer import Snapshot

HEAD_CAMERA = "edgevox_head_camera"
"""A camera on a mocap body of the same name: the scene's owner moves it."""

_MOST_BODIES = 2000
_LARGEST_BYTES = 50_000_000
_GRID_M = 1.0


def read_robot(path: Path) -> tuple[mujoco.MjSpec, str]:
    """The robot in a room of its own, and the name of its base, which has a free joint.

    Keyframes and actuators of the file are left out: who walks it brings its own. Raises
    `InvalidValue` for the field `mjcf`, with what was expected.
    """
    with open_file(path, "mjcf", _LARGEST_BYTES):
        pass  # MuJoCo, which opens it itself, waits for a pipe and reads a device for ever
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, OSError) as error:
        raise InvalidValue("mjcf", str(path), f"a robot in MJCF ({_line(error)})") from None
    base = _base(spec)
    if base is None:
        expected = "a robot whose base (pelvis or torso) is a body of the world with a free joint"
        raise InvalidValue("mjcf", str(path), expected)
    base.name = base.name or "edgevox_base"
    for part in (*spec.keys, *spec.actuators):
        spec.delete(part)
    _furnish(spec, base)
    return spec, base.name


def compile_robot(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    """The model. Raises `InvalidValue` for the field `mjcf` if MuJoCo does not take it."""
    try:
        model = spec.compile()
    except (ValueError, OSError) as error:
        raise InvalidValue("mjcf", str(path), f"a robot in MJCF ({_line(error)})") from None
    if model.nbody > _MOST_BODIES:
        raise InvalidValue("mjcf", str(path), f"a robot of at most {_MOST_BODIES} bodies")
    return model


def _base(spec: mujoco.MjSpec) -> mujoco.MjsBody | None:
    """The free body of the world that carries the most joints: a ball beside the robot has one."""
    free = [
        body
        for body in spec.worldbody.bodies
        if any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in body.joints)
    ]
    return max(free, key=lambda body: len(body.find_all("joint")), default=None)


def _furnish(spec: mujoco.MjSpec, base: mujoco.MjsBody) -> None:
    """A floor and light, unless the file is a scene that has a floor; and the head camera."""
    world = spec.worldbody
    if not any(geom.type == mujoco.mjtGeom.mjGEOM_PLANE for geom in world.geoms):
        _add_floor(spec)
        _add_light(spec, base)
    body = world.add_body(name=HEAD_CAMERA, mocap=True)
    body.add_camera(name=HEAD_CAMERA, quat=[0.5, 0.5, -0.5, -0.5])  # from looking along -z to x


def _add_light(spec: mujoco.MjSpec, base: mujoco.MjsBody) -> None:
    """A lamp that goes with the robot, so that its shadow is sharp everywhere."""
    for light in list(spec.lights):
        spec.delete(light)
    base.add_light(
        pos=[0, 0, 4],
        dir=[0, 0, -1],  # a slanted one draws dots on the floor where its shadows end
        mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACK,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        diffuse=[0.6, 0.6, 0.6],
        castshadow=True,
    )
    spec.visual.headlight.ambient[:] = 0.35
    spec.visual.headlight.diffuse[:] = 0.4


def _add_floor(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="edgevox_sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.75, 0.82, 0.9],
        rgb2=[0.95, 0.96, 0.98],
        width=64,
        height=384,
    )
    spec.add_texture(
        name="edgevox_grid",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=[0.62, 0.66, 0.7],
        rgb2=[0.55, 0.59, 0.64],
        markrgb=[0.85, 0.87, 0.9],
        width=256,
        height=256,
    )
    grid = spec.add_material(name="edgevox_grid", texrepeat=[0.5 / _GRID_M] * 2, texuniform=True)
    grid.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "edgevox_grid"
    spec.worldbody.add_geom(
        name="edgevox_floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 0.05],
        material="edgevox_grid",
    )


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]


RISE_M_S2 = 1.0
RISE_RAD_S2 = 2.0


def eased(now: WalkingCommand, wanted: WalkingCommand, seconds: float) -> WalkingCommand:
    """Return the next command: `wanted`, or as near to it as speeds may rise in this time."""
    if wanted == now:
        return now
    return WalkingCommand(
        _risen(now.forward_m_s, wanted.forward_m_s, RISE_M_S2 * seconds),
        _risen(now.left_m_s, wanted.left_m_s, RISE_M_S2 * seconds),
        _risen(now.turn_rad_s, wanted.turn_rad_s, RISE_RAD_S2 * seconds),
    )


def _risen(now: float, wanted: float, most: float) -> float:
    if wanted >= 0.0:
        return min(wanted, max(now, 0.0) + most)
    return max(wanted, min(now, 0.0) - most)


class MujocoHumanoidEnvironment:
    """A robot of an MJCF file on a wide floor, stepped by its owner. Not thread-safe.

    With a walking policy the robot walks in physics: every force is MuJoCo's, and it can fall.
    Without one, a procedural gait sets the positions of its base and joints, and `simulation` is
    "kinematic". `seed` decides the only randomness: how evenly it stands at the start. Raises
    `InvalidValue` for the fields `mjcf` and `policy`.
    """

    def __init__(self, mjcf: Path, policy: WalkingPolicy | None = None, *, seed: int = 0) -> None:
        self._mjcf, self._seed = mjcf, seed
        self.set_walking_policy(policy)

    def set_walking_policy(self, policy: WalkingPolicy | None) -> None:
        """Walk by this policy from now on, or by the procedural gait with None.

        The robot is built anew with the servos that `policy.plan` asks for and stands at the
        start; `model` is another one then, so call it before a body is made of this environment.
        Every `plan.period_s` of simulated time `policy.act` is given an `Observation` (the asked
        velocity, and what a real robot's sensors tell: angular velocity, direction of gravity,
        joint angles and speeds) and answers with a target angle for each joint. The module
        `policy` has all of it, `onnx_policy` an example. Raises `InvalidValue` if the robot lacks
        one of the policy's joints, or falls with it before it was asked for anything.
        """
        self._policy, self._command = policy, STAND
        spec, base = read_robot(self._mjcf)
        if policy is None:
            model = compile_robot(spec, self._mjcf)
            self._walker: Walker = KinematicWalker(model, base)
        else:
            fit_servos(spec, policy.plan)
            model = compile_robot(spec, self._mjcf)
            self._walker = PhysicsWalker(model, base, policy, np.random.default_rng(self._seed))
        body = self.model.body(HEAD_CAMERA)
        self._camera_mount = int(self.model.body_mocapid[body.id])

    @property
    def policy(self) -> WalkingPolicy | None:
        """The policy, if it walks in physics; else None."""
        return self._policy

    @property
    def walker(self) -> Walker:
        """The walker, for tests and diagnosis."""
        return self._walker

    @property
    def simulation(self) -> Literal["physics", "kinematic"]:
        """The kind of simulation.

        "physics" by forces, "kinematic" by a procedural gait's positions.
        """
        return self._walker.simulation

    @property
    def gait(self) -> str:
        """The source of its steps: the policy's name, or "procedural gait"."""
        return self._walker.name

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model; it stays until another policy is set."""
        return self._walker.model

    @property
    def data(self) -> mujoco.MjData:
        """MuJoCo's state, in which a test may push the robot."""
        return self._walker.data

    @property
    def limits(self) -> WalkerLimits:
        """The limits of its speed and precision."""
        return self._walker.limits

    @property
    def period_s(self) -> float:
        """The simulated time that one `step` takes."""
        return self._walker.period_s

    @property
    def pose(self) -> Pose2D:
        """The pelvis on the floor, and which way it looks."""
        return self._walker.base.pose

    @property
    def velocity(self) -> Twist2D:
        """The pelvis's velocity: ahead, and turning."""
        return self._walker.base.velocity()

    @property
    def height_m(self) -> float:
        """The height of the pelvis above the floor."""
        return self._walker.base.height_m

    @property
    def stand_height_m(self) -> float:
        """The height of the pelvis above the floor while it stands."""
        return self._walker.base.stand_height_m

    @property
    def fallen(self) -> bool:
        """Whether its pelvis was low or tilted far, and it has not been put upright since."""
        return self._walker.base.fallen

    def step(self, wanted: WalkingCommand) -> None:
        """Let `period_s` pass, walking at this velocity, to which its speed rises evenly.

        Raises `ArithmeticError` if its numbers broke; the robot stands again then, where it was.
        """
        before = self.pose
        self._command = eased(self._command, wanted, self.period_s)
        try:
            self._walker.step(self._command)
            if not self._walker.base.finite:
                raise ArithmeticError("the robot's motion became infinite; it was put upright")
        except Exception:
            self._put(before)
            raise

    def reset(self) -> None:
        """Back to the start, upright."""
        self._put(Pose2D(0.0, 0.0, 0.0))

    def stand_up(self) -> None:
        """Upright again where it lies, looking the way it looks: put there, not risen by itself."""
        self._put(self.pose)

    def _put(self, pose: Pose2D) -> None:
        self._command = STAND
        self._walker.put(pose)

    def snapshot(
        self, time_s: float, camera: Pose2D, camera_height_m: float, down_rad: float
    ) -> Snapshot:
        """A copy of now, to be drawn later, with the head camera there, looking down a little."""
        moment = Snapshot.of(self.data, time_s)
        looks = compose(lift(camera), pitch(down_rad))
        moment.mocap_pos[self._camera_mount] = camera.x_m, camera.y_m, camera_height_m
        moment.mocap_quat[self._camera_mount] = looks.qw, looks.qx, looks.qy, looks.qz
        return moment
