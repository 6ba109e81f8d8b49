"""Plans keep clear of everything, or say in words why there is none."""

import math
from itertools import pairwise

import numpy as np
import phrases
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D
from edgevox.robots.flat.planner import PathPlanner
from edgevox.robots.shapes import Point, distance, inside, place
from edgevox.robots.world.load import load_world, parse_world
from edgevox.robots.world.model import World

APARTMENT = load_world()
PLANNER = PathPlanner(APARTMENT)
MOVABLE = tuple(thing.pose for thing in APARTMENT.movable)
START = (APARTMENT.robot.start.x_m, APARTMENT.robot.start.y_m)

DIVIDED = """
world: {width: 6, height: 4}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 2, 0]}
obstacle:
  - {name: wall, shape: {name: linestring, vertices: [[3, 0], [3, 1.5]]}, state: [0, 0, 0]}
  - {name: wall, shape: {name: linestring, vertices: [[3, 2.5], [3, 4]]}, state: [0, 0, 0]}
  - {name: crate, shape: {name: rectangle, length: 0.6, width: 0.8}, state: [3, 2, 0], mass: 5}
"""


def gap(world: World, path: tuple[Point, ...], movable: tuple[Pose2D, ...]) -> float:
    """How near a path comes to anything."""
    points = np.vstack(
        [np.linspace(a, b, max(2, int(math.dist(a, b) / 0.01))) for a, b in pairwise(path)]
    )
    shapes = [
        place(part, pose)
        for thing, pose in (
            *((t, t.pose) for t in world.fixed),
            *zip(world.movable, movable, strict=True),
        )
        for part in thing.parts
    ]
    return min(float(distance(shape, points).min()) for shape in shapes)


def refused(world: World, goal: Point, code: str, **about: str) -> bool:
    """Whether no way there is found, for the reason of this code."""
    start = (world.robot.start.x_m, world.robot.start.y_m)
    with pytest.raises(SkillFailed) as caught:
        PathPlanner(world).plan(start, goal, tuple(t.pose for t in world.movable))
    return phrases.because(code, **about)(caught.value)


@pytest.mark.parametrize("room", APARTMENT.rooms, ids=lambda room: room.name)
def test_a_path_to_each_room_begins_and_ends_where_asked_and_touches_nothing(room) -> None:
    path = PLANNER.plan(START, room.goal, MOVABLE)

    assert (path[0], path[-1]) == (START, room.goal)
    assert gap(APARTMENT, path, MOVABLE) > APARTMENT.robot.radius_m


@settings(max_examples=40, deadline=None)
@given(st.floats(0, 10), st.floats(0, 10))
def test_any_point_is_either_reached_without_a_touch_or_refused(x: float, y: float) -> None:
    try:
        path = PLANNER.plan(START, (x, y), MOVABLE)
    except SkillFailed:
        return
    assert path[-1] == (x, y)
    assert gap(APARTMENT, path, MOVABLE) >= APARTMENT.robot.radius_m - 1e-9


@pytest.mark.parametrize(
    ("goal", "code", "about"),
    [
        ((12.0, 3.0), "outside", {"place": "apartment", "x_min": "0", "x_max": "10"}),
        ((3.0, -0.1), "outside", {"place": "apartment", "y_min": "0", "y_max": "10"}),
        ((5.8, 1.0), "taken", {"thing": "a wall"}),
        ((0.7, 2.6), "taken", {"thing": "a sofa"}),
        ((7.6, 4.1), "taken", {"thing": "a chair"}),
        ((7.6, 8.6), "taken", {"thing": "an office chair"}),
        ((5.6, 1.0), "too_close", {"thing": "a wall"}),
    ],
)
def test_a_goal_that_cannot_be_is_refused_with_the_reason(
    goal: Point, code: str, about: dict[str, str]
) -> None:
    assert refused(APARTMENT, goal, code, **about)


def test_a_point_behind_walls_cannot_be_reached() -> None:
    closed = DIVIDED.replace("[3, 2.5]", "[3, 1.5]")

    assert refused(parse_world(closed, "hall.yaml"), (5.0, 2.0), "no_way")


def test_a_door_that_furniture_blocks_is_told_from_a_wall() -> None:
    assert refused(parse_world(DIVIDED, "hall.yaml"), (5.0, 2.0), "furniture")


def test_furniture_is_avoided_where_it_is_now_not_where_it_was() -> None:
    world = parse_world(DIVIDED, "hall.yaml")
    moved = (Pose2D(1.0, 3.4, 0.3),)

    path = PathPlanner(world).plan((1.0, 2.0), (5.0, 2.0), moved)

    assert path == ((1.0, 2.0), (5.0, 2.0))


def test_a_robot_that_stands_against_a_wall_gets_away() -> None:
    world = parse_world(DIVIDED, "hall.yaml")

    path = PathPlanner(world).plan((0.2, 0.2), (1.0, 2.0), (Pose2D(5.0, 1.0, 0.0),))

    assert path[0] == (0.2, 0.2)
    assert path[-1] == (1.0, 2.0)


def test_in_a_large_world_with_coarse_cells_no_path_goes_through_a_thin_wall() -> None:
    world = parse_world(
        """
world: {width: 400, height: 400}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [100, 200, 0]}
obstacle:
  - {shape: {name: linestring, vertices: [[200.2, 0], [200.2, 400]]}, state: [0, 0, 0]}
""",
        "field.yaml",
    )

    assert refused(world, (300.0, 200.0), "no_way")
    assert PathPlanner(world).plan((100.0, 200.0), (190.0, 10.0), ())[-1] == (190.0, 10.0)


ROOMS = {room.name: room for room in APARTMENT.rooms}


def crossed(path: tuple[Point, ...], room: str) -> list[bool]:
    """Whether each point of a path is in a room."""
    points = np.vstack([np.linspace(a, b, 200) for a, b in pairwise(path)])
    return [bool(one) for one in inside(ROOMS[room].outline, points)]


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(sorted(ROOMS)), st.floats(0, 10), st.floats(0, 10))
def test_no_path_enters_a_forbidden_room_and_one_that_begins_there_leaves_it_for_good(
    room: str, x: float, y: float
) -> None:
    for start in (one.goal for one in ROOMS.values()):
        try:
            path = PLANNER.plan(start, (x, y), MOVABLE, [ROOMS[room]])
        except SkillFailed:
            continue
        there = crossed(path, room)
        begins = there[0]
        assert not any(there[there.index(False) :] if begins else there)


def test_a_goal_in_a_forbidden_room_is_refused_and_so_is_one_behind_it() -> None:
    forbidden = [ROOMS["bedroom"], ROOMS["kitchen"]]
    for goal, code in (
        (ROOMS["bedroom"].goal, "policy_place"),
        (ROOMS["office"].goal, "policy_way"),
    ):
        with pytest.raises(SkillFailed) as caught:
            PLANNER.plan(START, goal, MOVABLE, forbidden)
        assert caught.value.reason.code == code
