"""The map that a robot makes of where it is, as the page draws it: each wall where it is."""

import base64
import io
import math

import numpy as np
import pytest
from browser_rig import Opens
from PIL import Image
from playwright.sync_api import Page
from stand_in import HELLO, Robot
from test_page_drives import until

from edgevox.apps.console.shown_robot import MapGrid
from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import FREE, OCCUPIED, UNKNOWN, OccupancyMap

CELL_M, YAW, CORNER = 0.5, 0.4, (2.0, -3.0)
CELLS = np.full((10, 16), FREE, np.uint8)
CELLS[0], CELLS[-1], CELLS[:, 0], CELLS[:, -1] = [OCCUPIED] * 4
CELLS[1:6, 6] = OCCUPIED
CELLS[6:9, 12:15] = UNKNOWN
GRID = OccupancyMap(CELLS, CELL_M, Pose2D(*CORNER, YAW))
WALL, INSIDE, NOWHERE = (3, 6), (3, 9), (7, 13)
"""Cells, row and column: of a wall, a free one, one that nobody knows."""
COLOURS = {"floor": UNKNOWN, "room": FREE, "wall": OCCUPIED}


def scene(grid: OccupancyMap, version: int = 1) -> dict:
    xs, ys = zip(*grid.corners(), strict=True)
    bounds = [min(xs), min(ys), max(xs), max(ys)]
    return {"version": version, "bounds": bounds, "grid": MapGrid().as_json(grid)}


@pytest.fixture
def mapped(robot: Robot) -> Robot:
    robot.scene = scene(GRID)
    robot.hello = {**HELLO, "capabilities": {"map": True, "goto": True}}
    robot.live = {"pose": {"x": 3.0, "y": -1.0, "yaw": 0.0}, "goal": None}
    return robot


def middle(cell: tuple[int, int]) -> tuple[float, float]:
    """Of a cell, metres, map frame."""
    return to_map(((cell[1] + 0.5) * CELL_M, (cell[0] + 0.5) * CELL_M), GRID.origin)


def on_canvas(page: Page, x_m: float, y_m: float) -> tuple[float, float]:
    """Where the page draws a point while it shows the whole map: all of its bounds, centred."""
    wide, high = page.locator(".map").evaluate("e => [e.clientWidth, e.clientHeight]")
    x0, y0, x1, y1 = scene(GRID)["bounds"]
    scale = min((wide - 24) / (x1 - x0), (high - 24) / (y1 - y0))
    return (
        wide / 2 + (x_m - (x0 + x1) / 2) * scale,
        high / 2 - (y_m - (y0 + y1) / 2) * scale,
    )


def seen(page: Page, cell: tuple[int, int]) -> int:
    """What the pixel in the middle of a cell says that it is; -1 for no colour of a cell."""
    x, y = on_canvas(page, *middle(cell))
    shown = page.locator(".map").evaluate(
        """(e, at) => {
            const dense = e.width / e.clientWidth;
            const of = g => [...g.getImageData(0, 0, 1, 1).data].join();
            const style = getComputedStyle(document.documentElement);
            const one = Object.assign(document.createElement("canvas"), {width: 1, height: 1});
            const g = one.getContext("2d");
            const is = {};
            for (const name of at.names) {
                g.fillStyle = style.getPropertyValue("--" + name).trim();
                g.fillRect(0, 0, 1, 1);
                is[of(g)] = name;
            }
            const pixel = e.getContext("2d").getImageData(at.x * dense, at.y * dense, 1, 1);
            return is[[...pixel.data].join()] ?? ""; }""",
        {"x": x, "y": y, "names": list(COLOURS)},
    )
    return COLOURS.get(shown, -1)


@pytest.mark.parametrize("colours", ["light", "dark"])
def test_each_cell_is_drawn_where_it_is_by_day_and_by_night(
    opens: Opens, mapped: Robot, colours: str
) -> None:
    page = opens(viewport={"width": 1440, "height": 900}, color_scheme=colours)
    drawn = {WALL: OCCUPIED, INSIDE: FREE, NOWHERE: UNKNOWN}
    drawn |= dict.fromkeys(((0, 3), (9, 8), (4, 0), (6, 15)), OCCUPIED)
    until(page, lambda: {cell: seen(page, cell) for cell in drawn} == drawn)


def test_the_colours_change_with_those_of_the_page(opens: Opens, mapped: Robot) -> None:
    page = opens(viewport={"width": 1440, "height": 900}, color_scheme="light")
    until(page, lambda: seen(page, WALL) == OCCUPIED)
    page.emulate_media(color_scheme="dark")
    until(page, lambda: seen(page, WALL) == OCCUPIED and seen(page, INSIDE) == FREE)


def test_a_new_map_takes_the_place_of_the_old_one_and_none_leaves_none(
    opens: Opens, mapped: Robot
) -> None:
    page = opens()
    until(page, lambda: seen(page, WALL) == OCCUPIED)
    opened = CELLS.copy()
    opened[WALL] = FREE
    mapped.tell(type="scene", **scene(OccupancyMap(opened, CELL_M, GRID.origin), 2))
    until(page, lambda: seen(page, WALL) == FREE)
    mapped.tell(type="scene", version=3, bounds=scene(GRID)["bounds"])
    until(page, lambda: seen(page, WALL) == UNKNOWN)


def test_a_tap_on_a_cell_goes_to_that_point_of_the_map(opens: Opens, mapped: Robot) -> None:
    page = opens()
    page.locator(".facts .fact").first.wait_for()  # what they take of the map's height is taken
    until(page, lambda: seen(page, WALL) == OCCUPIED)
    x_m, y_m = middle(INSIDE)
    x, y = on_canvas(page, x_m, y_m)
    page.locator(".map").click(position={"x": x, "y": y})
    page.get_by_role("button", name="Go there").click()
    until(page, lambda: bool(mapped.commands("goto")))
    went = mapped.commands("goto")[0]
    assert (went["x"], went["y"]) == pytest.approx((x_m, y_m), abs=0.05)


def test_the_robot_and_its_lidar_are_drawn_over_it(opens: Opens, mapped: Robot) -> None:
    at = middle(WALL)
    mapped.live = {"pose": {"x": at[0], "y": at[1], "yaw": math.pi}, "lidar": [*middle((9, 8))]}
    page = opens()
    until(page, lambda: seen(page, (6, 15)) == OCCUPIED)
    until(page, lambda: (seen(page, WALL), seen(page, (9, 8))) == (-1, -1))


def test_a_picture_that_is_none_leaves_the_map_that_was_there(opens: Opens, mapped: Robot) -> None:
    page = opens()
    until(page, lambda: seen(page, WALL) == OCCUPIED)
    broken = {**scene(GRID, 2)["grid"], "png": base64.b64encode(b"no picture").decode()}
    mapped.tell(type="scene", **{**scene(GRID, 2), "grid": broken})
    mapped.tell(type="talk", kind="heard", turn=1, text="after it")
    page.get_by_text("after it").wait_for()
    assert seen(page, WALL) == OCCUPIED


def test_its_picture_is_one_pixel_a_cell() -> None:
    picture = Image.open(io.BytesIO(base64.b64decode(scene(GRID)["grid"]["png"])))
    assert picture.size == (16, 10)
