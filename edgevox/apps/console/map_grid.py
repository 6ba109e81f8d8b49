"""The map that others make, as a page draws it: a picture, one pixel a cell, and where it lies."""

import base64
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.robots.occupancy_map import OccupancyMap

GREYS = (0, 128, 255)
"""Of a cell that is unknown, free or occupied; which colours they get is the page's."""
BITS = 2


class MapGrid:
    """Makes the picture once for each map. Thread-safe."""

    def __init__(self) -> None:
        self._made: tuple[NDArray[np.uint8] | None, str] = (None, "")

    def as_json(self, grid: OccupancyMap) -> dict[str, Any]:
        """`x`, `y` and `yaw` are its lower left corner in the map frame; metres, radians."""
        cells, png = self._made
        if cells is not grid.cells:
            png = _png(grid.cells)
            self._made = (grid.cells, png)
        origin = grid.origin
        return {
            "png": png,
            "x": round(origin.x_m, 3),
            "y": round(origin.y_m, 3),
            "yaw": round(origin.yaw_rad, 5),
            "resolution": round(grid.resolution_m, 6),
        }


def _png(cells: NDArray[np.uint8]) -> str:
    """In base64; its first row is the upper edge."""
    from PIL import Image  # which only pictures need

    image = Image.fromarray(np.ascontiguousarray(cells[::-1]))
    image.putpalette([grey for grey in GREYS for _ in "rgb"])
    file = io.BytesIO()
    image.save(file, format="PNG", bits=BITS)
    return base64.b64encode(file.getvalue()).decode("ascii")
