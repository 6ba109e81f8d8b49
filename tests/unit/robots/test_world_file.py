"""A world file is IR-SIM's own format. Wrong ones: tests/wrong/world."""

import math

import pytest
import yaml

from edgevox.robots.shapes import Circle, Line, Polygon
from edgevox.robots.world.load import apartment_file, load_world, parse_world

ROBOT = "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0]}\n"


def test_the_apartment_has_four_rooms_and_things_that_can_and_cannot_be_pushed() -> None:
    world = load_world()

    assert {room.spoken for room in world.rooms} == {"kitchen", "bedroom", "living room", "office"}
    assert (world.width_m, world.height_m) == (10, 10)
    assert {t.spoken for t in world.movable} >= {"chair", "box", "armchair"}
    assert {t.spoken for t in world.fixed} >= {"wall", "sofa", "kitchen counter"}
    assert world.robot.lidar.beams == 360
    assert all(world.room_at(*room.goal) is room for room in world.rooms)


def test_an_irsim_world_with_a_group_circles_boxes_and_lines_loads() -> None:
    world = parse_world(
        """
world: {height: 50, width: 40, step_time: 0.1, sample_time: 0.1, offset: [-5, 5],
        collision_mode: stop, control_mode: auto}
robot:
  - kinematics: {name: 'diff'}
    shape: {name: 'rectangle', length: 0.6, width: 0.8}
    state: [1, 8, 1.57]
    goal: [30, 40, 0]
    behavior: {name: 'dash'}
    vel_max: [2, 1.5]
    acce: [3, .inf]
    plot: {show_trail: true}
    sensors:
      - {type: 'lidar2d', range_min: 0, range_max: 7, angle_range: 3.14, number: 100, noise: false}
obstacle:
  - number: 4
    distribution: {name: 'manual'}
    state: [[4, 18], [31, 38, 1], [10, 20], [14, 25], [99, 99]]
    shape:
      - {name: 'circle', radius: 0.4}
      - {name: 'circle', radius: 0.1}
    kinematics: {name: 'omni'}
    color: 'k'
  - shape: {name: 'linestring', vertices: [[5, 25], [4, 20], [1, 26]]}
    state: [0, 0, 0]
  - shape: {name: 'polygon', vertices: [[20, 20], [22, 20], [22, 23], [20, 20]]}
  - {shape: {name: rectangle, length: 1, width: 2}, state: [8, 30, 1], unobstructed: true}
""",
        "big.yaml",
    )

    circles = world.things[:4]
    assert [c.parts[0].radius_m for c in circles if isinstance(c.parts[0], Circle)] == [
        0.4,
        0.1,
        0.1,
        0.1,
    ]
    assert (circles[1].pose.x_m, circles[1].pose.yaw_rad) == (31, 1)
    assert circles[0].movable, "what drives by itself in IR-SIM can be pushed here"
    assert isinstance(world.things[4].parts[0], Line)
    polygon = world.things[5].parts[0]
    assert isinstance(polygon, Polygon)
    assert len(polygon.vertices) == 3
    assert len(world.things) == 6, "what nothing touches is not there"
    assert world.robot.radius_m == pytest.approx(0.5)
    assert (world.robot.max_linear_m_s, world.robot.max_angular_rad_s) == (2, 1.5)
    assert (world.robot.max_linear_m_s2, world.robot.max_angular_rad_s2) == (3, 6)
    assert (world.x_min_m, world.y_max_m) == (-5, 55)


def test_an_irsim_world_with_several_robots_on_a_circle_drives_the_first() -> None:
    world = parse_world(
        """
world: {height: 10, width: 10}
robot:
  number: 5
  distribution: {name: circle, radius: 4.0, center: [5, 5]}
  kinematics: {name: diff}
  shape: [{name: circle, radius: 0.2}]
  behavior: {name: rvo, vxmax: 1.0}
  color: [red, green, blue]
gui: {}
""",
        "ring.yaml",
    )

    assert (world.robot.start.x_m, world.robot.start.y_m) == (9, 5)
    assert [t.movable for t in world.things] == [True] * 4


def test_a_random_irsim_world_is_the_same_every_time_and_keeps_its_distances() -> None:
    text = ROBOT + (
        "obstacle: {number: 6, distribution: {name: random, range_low: [3, 3, -3], "
        "range_high: [9, 9, 3], min_distance: 1.5}, shape: {name: circle, radius: 0.2}}"
    )

    first, second = parse_world(text, "a.yaml"), parse_world(text, "a.yaml")

    assert first.things == second.things
    assert first.things != parse_world(text, "a.yaml", seed=1).things
    spots = [(t.pose.x_m, t.pose.y_m) for t in first.things]
    assert min(math.dist(a, b) for a in spots for b in spots if a != b) >= 1.5


def test_a_compound_shape_has_its_parts_where_their_poses_say() -> None:
    world = parse_world(
        ROBOT + "obstacle: [{shape: {name: compound, parts: ["
        "{name: circle, radius: 0.1, pose: [2, 0, 0]}, {name: rectangle, length: 1, width: 1}]},"
        " state: [5, 5, 0], mass: 3}]",
        "c.yaml",
    )

    assert world.movable[0].parts[0] == Circle((2.0, 0.0), 0.1)


def test_a_file_that_is_shared_with_another_simulator_has_its_world_under_irsim() -> None:
    body = yaml.safe_load(ROBOT)

    world = parse_world(yaml.safe_dump({"irsim": body, "gazebo": {}}), "shared.yaml")

    assert world.robot.radius_m == 0.2


def test_unknown_keys_that_resemble_nothing_are_ignored_as_in_irsim(
    caplog: pytest.LogCaptureFixture,
) -> None:
    parse_world("world: {zzz: 1}\n" + ROBOT, "home.yaml")

    assert "world_key_ignored where='home.yaml:1: world.zzz'" in caplog.text


def test_the_apartment_says_nothing_that_irsim_refuses() -> None:
    data = yaml.safe_load(apartment_file().read_text("utf-8"))

    assert set(data) == {"world", "robot", "obstacle", "custom"}
    assert "name" not in data["world"], "IR-SIM takes it from the file and fails on a second one"
