"""The map of a robot comes from a process of its own, and is shown where the robot is in it."""

import contextlib
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from external_rig import heard, robot_process, wheels
from interop_rig import hear
from map_server import CELL_M, COLUMNS, ROWS
from nav_msgs.msg import OccupancyGrid
from peer import STATE, Peer
from waiting import wait_until

from edgevox.core.errors import Refusal
from edgevox.robots.capabilities import FREE, OCCUPIED, OccupancyMap
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import ExternalSettings

JOINED = ("--map-to-odom", "3,-2,1.2")
"""Odometry is not the map's frame, but /tf says where it is in it."""


@pytest.fixture
def rig(domain, monkeypatch) -> Iterator["Rig"]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with contextlib.ExitStack() as stack:
        yield Rig(domain, stack)


class Rig:
    """Starts what there is: a map server, a robot's wheels, and the body that hears them."""

    def __init__(self, domain: int, stack: contextlib.ExitStack) -> None:
        self._domain, self._stack = domain, stack

    def serve(self, *arguments: str) -> None:
        process = robot_process(
            "map_server.py", *arguments, domain=self._domain, namespace="/robot1"
        )
        self._stack.enter_context(process)

    def body(self, *wheels_arguments: str, **changes: object) -> ExternalRobot:
        self._stack.enter_context(
            wheels(*wheels_arguments, domain=self._domain, namespace="/robot1")
        )
        body = ExternalRobot("/robot1", settings=replace(ExternalSettings(), **changes))
        self._stack.callback(body.close)
        body.start()
        heard(body)
        return body


def shown(body: ExternalRobot) -> OccupancyMap:
    wait_until(lambda: body.newest_map() is not None, "the map")
    return body.newest_map()


def walls(grid: OccupancyMap, column: int) -> bool:
    """Whether a whole column of the room is a wall."""
    return bool((grid.cells[:, column] == OCCUPIED).all())


def heard_by_server(body: ExternalRobot, control: Peer) -> None:
    """Tell the map server until it has heard, which may not know a peer that has just come."""

    def is_shown() -> bool:
        control.send("do", "wall 10")
        newest = body.newest_map()
        return newest is not None and walls(newest, 10)

    wait_until(is_shown, "a wall")


def test_who_comes_later_is_shown_the_room_and_not_what_is_unknown_around_it(rig, peer):
    rig.serve()
    hear(peer(), OccupancyGrid, "/robot1/map", STATE).wait_for(lambda _: True)
    grid = shown(rig.body(*JOINED))
    assert grid.cells.shape == (ROWS, COLUMNS)
    assert (grid.cells[1:-1, 1:-1] == FREE).all()
    assert walls(grid, 0)
    assert walls(grid, -1)
    assert (grid.origin.x_m, grid.origin.y_m) == pytest.approx((-1.0, -2.0), abs=1e-6)
    assert grid.origin.yaw_rad == pytest.approx(0.0)
    assert grid.resolution_m == pytest.approx(CELL_M)


def test_a_newer_map_takes_the_place_of_the_old_one_and_a_lie_does_not(rig, peer, caplog):
    rig.serve()
    body, control = rig.body(*JOINED), peer("/robot1")
    first = shown(body)
    assert not walls(first, 20)
    heard_by_server(body, control)
    control.send("do", "wall 20")
    wait_until(lambda: walls(body.newest_map(), 20), "the wall")
    second = body.newest_map().cells
    assert body.newest_map().cells is second
    refused = ("/robot1/map", Refusal.IMPLAUSIBLE)
    for count, lie in enumerate(("short", "nowhere"), start=1):
        control.send("do", lie)
        wait_until(lambda: body.newest_map() and body.refusals[refused] == count, lie)  # noqa: B023
        assert body.newest_map().cells is second
    assert "map_impossible" in caplog.text
    control.send("do", "wall 30")
    wait_until(lambda: walls(body.newest_map(), 30), "the next map")


def test_a_map_that_is_kept_for_nobody_is_heard_when_it_is_published(rig, peer):
    rig.serve("--volatile")
    body, control = rig.body(*JOINED), peer("/robot1")
    heard_by_server(body, control)


def test_a_map_in_another_frame_is_turned_into_that_of_the_robots_pose(rig):
    rig.serve("--frame", "odom")
    body = rig.body(*JOINED)
    wait_until(lambda: body.state()["frame"] == "map", "the transform")
    grid = shown(body)
    cos, sin = math.cos(1.2), math.sin(1.2)
    corner = (3 + cos * -1.0 - sin * -2.0, -2 + sin * -1.0 + cos * -2.0)
    assert (grid.origin.x_m, grid.origin.y_m) == pytest.approx(corner, abs=1e-6)
    assert grid.origin.yaw_rad == pytest.approx(1.2)


def test_a_map_that_no_transform_joins_to_the_robot_is_not_shown_to_be_tapped_on(rig, caplog):
    rig.serve()
    body = rig.body()  # its odometry's frame hangs from nothing

    def refused() -> bool:
        assert body.newest_map() is None
        return "map_elsewhere" in caplog.text

    wait_until(refused, "the warning")
    assert caplog.text.count("map_elsewhere") == 1


def test_the_map_may_be_called_otherwise(rig):
    rig.serve("--topic", "/floor/plan")
    body = rig.body(*JOINED, remappings=("--ros-args", "-r", "map:=/floor/plan"))
    assert np.count_nonzero(shown(body).cells == OCCUPIED) == 2 * COLUMNS + 2 * ROWS - 4
