"""A robot's MJCF file, checked, and put on a lit floor with a grid."""

from pathlib import Path

import mujoco

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import open_file

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
