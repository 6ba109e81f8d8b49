"""The scene around the arm: floor, table, cubes, bins, light and cameras, added to its model."""

from pathlib import Path

import mujoco

from edgevox.core.errors import InvalidValue
from edgevox.robots.mujoco.renderer import RoomCamera
from edgevox.robots.panda import table
from edgevox.robots.panda.table import BINS, CUBES, Bin, Cube

STEP_S = 0.002
TCP = "tcp"
CAMERA = RoomCamera("room", (1.25, 0.0, 0.75), (0.42, 0.0, 0.05))
SHOW = RoomCamera("show", (1.45, -0.95, 0.95), (0.28, 0.03, 0.20))

LEAD_S = 0.05
"""The delay of the joints behind their motors' targets: the motors' damping over their
stiffness."""

_STIFFNESS = (2000.0, 2000.0, 2000.0, 2000.0, 800.0, 800.0, 800.0)
"""N m/rad, softer than in the model, whose motors rattle for good once one of them saturates: the
integrator damps them implicitly only while none does, and their damping is too much without."""
_BETWEEN_FINGERS_M = 0.1034
_FRICTION = (1.0, 0.005, 0.0001)
_WOOD = (0.80, 0.66, 0.48, 1.0)
_METAL = (0.30, 0.32, 0.36, 1.0)
_BOX = mujoco.mjtGeom.mjGEOM_BOX


def build(model_path: Path) -> mujoco.MjModel:
    """The whole scene. Raises `InvalidValue` if that file is not a Panda with its gripper."""
    spec = arm_spec(model_path)
    spec.option.timestep = STEP_S
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    _room(spec)
    _table(spec)
    for one in BINS.values():
        _bin(spec, one)
    for cube in CUBES.values():
        _cube(spec, cube)
    for camera in (CAMERA, SHOW):
        camera.add_to(spec)
    return spec.compile()


def arm_spec(model_path: Path) -> mujoco.MjSpec:
    """The arm alone, with a site between its fingers, its weight carried by its motors."""
    try:
        spec = mujoco.MjSpec.from_file(str(model_path))
    except (ValueError, OSError) as error:
        raise InvalidValue("model_path", str(model_path), f"a readable MJCF: {error}") from error
    hand = spec.body("hand")
    if hand is None or spec.joint("finger_joint1") is None:
        raise InvalidValue("model_path", str(model_path), "a Franka Panda with its gripper")
    for key in list(spec.keys):
        spec.delete(key)
    for body in spec.bodies[1:]:
        body.gravcomp = 1.0
    for number, stiffness in enumerate(_STIFFNESS, start=1):
        motor = spec.actuator(f"actuator{number}")
        motor.gainprm[0] = stiffness
        motor.biasprm[1:3] = -stiffness, -stiffness * LEAD_S
    hand.add_site(name=TCP, pos=[0.0, 0.0, _BETWEEN_FINGERS_M], size=[0.005] * 3, group=5)
    return spec


def _room(spec: mujoco.MjSpec) -> None:
    world = spec.worldbody
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.86, 0.90, 0.95],
        rgb2=[0.60, 0.68, 0.78],
        width=64,
        height=384,
    )
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.62, 0.65, 0.69],
        rgb2=[0.56, 0.59, 0.63],
        width=256,
        height=256,
    )
    tiles = spec.add_material(name="tiles", texrepeat=[1.2, 1.2], texuniform=True)
    tiles.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    world.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[4.0, 4.0, 0.1],
        pos=[0.0, 0.0, -table.TABLE_HEIGHT_M],
        material="tiles",
    )
    for light in list(spec.lights):
        spec.delete(light)
    for position, strength in (((0.9, -1.2, 2.4), 0.55), ((0.2, 1.4, 2.2), 0.30)):
        world.add_light(
            pos=position,
            dir=[0.4 - position[0], -position[1], -position[2]],
            diffuse=[strength] * 3,
            specular=[0.15] * 3,
            castshadow=strength > 0.5,
        )
    spec.visual.headlight.ambient = [0.38, 0.38, 0.38]
    spec.visual.headlight.diffuse = [0.22, 0.22, 0.22]
    spec.visual.headlight.specular = [0.0, 0.0, 0.0]
    spec.visual.map.znear = 0.02


def _table(spec: mujoco.MjSpec) -> None:
    world = spec.worldbody
    near, far = table.TABLE_X_M
    middle, half = (near + far) / 2, (far - near) / 2
    thickness = 0.04
    world.add_geom(
        name="table",
        type=_BOX,
        size=[half, table.TABLE_HALF_WIDTH_M, thickness / 2],
        pos=[middle, 0.0, -thickness / 2],
        friction=_FRICTION,
        rgba=_WOOD,
    )
    leg = (table.TABLE_HEIGHT_M - thickness) / 2
    for x in (near + 0.06, far - 0.06):
        for y in (-table.TABLE_HALF_WIDTH_M + 0.06, table.TABLE_HALF_WIDTH_M - 0.06):
            world.add_geom(
                type=_BOX,
                size=[0.03, 0.03, leg],
                pos=[x, y, -thickness - leg],
                rgba=_METAL,
            )


def _bin(spec: mujoco.MjSpec, one: Bin) -> None:
    """A floor and four walls."""
    body = spec.worldbody.add_body(name=one.name, pos=[*one.center, 0.0])
    outer, wall, high = one.half_m + one.wall_m, one.wall_m / 2, one.height_m / 2
    boxes = [((0.0, 0.0, one.floor_m / 2), (outer, outer, one.floor_m / 2))]
    for side in (-1.0, 1.0):
        away = side * (one.half_m + wall)
        boxes.append(((away, 0.0, high), (wall, outer, high)))
        boxes.append(((0.0, away, high), (outer, wall, high)))
    for position, size in boxes:
        body.add_geom(type=_BOX, pos=position, size=size, rgba=one.rgba, friction=_FRICTION)


def _cube(spec: mujoco.MjSpec, cube: Cube) -> None:
    half = table.CUBE_SIZE_M / 2
    body = spec.worldbody.add_body(name=cube.name, pos=[*cube.start, half])
    body.add_freejoint(name=cube.name)
    body.add_geom(
        name=cube.name,
        type=_BOX,
        size=[half] * 3,
        mass=table.CUBE_MASS_KG,
        friction=_FRICTION,
        condim=4,
        rgba=cube.rgba,
    )
