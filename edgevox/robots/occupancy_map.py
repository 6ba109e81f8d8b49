"""An occupancy map: a grid of unknown, free or occupied cells, coarse enough to look at."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.shapes import Point

UNKNOWN, FREE, OCCUPIED = 0, 1, 2
"""The larger one wins where several cells become one: no wall is lost."""


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyMap:
    """A grid in the map frame."""

    cells: NDArray[np.uint8]
    """Shape (rows, columns), row 0 at the lower edge."""
    resolution_m: float
    """The width of a cell."""
    origin: Pose2D
    """The lower left corner of cell (0, 0), map frame; rows run along its x axis."""

    def cropped(self) -> "OccupancyMap":
        """Return the known part; a map without cells if nothing is known."""
        rows = np.flatnonzero(self.cells.any(axis=1))
        columns = np.flatnonzero(self.cells.any(axis=0))
        if not len(rows):
            return replace(self, cells=self.cells[:0, :0])
        cells = self.cells[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        corner = int(columns[0]) * self.resolution_m, int(rows[0]) * self.resolution_m
        origin = Pose2D(*to_map(corner, self.origin), self.origin.yaw_rad)
        return replace(self, cells=cells, origin=origin)

    def reduced(self, most_cells: int) -> "OccupancyMap":
        """Return a map with at most this many cells along each side, merging cells as needed."""
        every = -(-max(self.cells.shape) // most_cells)
        if every <= 1:
            return self
        rows, columns = self.cells.shape
        padded = np.pad(self.cells, ((0, -rows % every), (0, -columns % every)))
        high, wide = padded.shape[0] // every, padded.shape[1] // every
        cells = padded.reshape(high, every, wide, every).max(axis=(1, 3))
        return replace(self, cells=cells, resolution_m=self.resolution_m * every)

    def corners(self) -> list[Point]:
        """Return the four corners, metres, map frame."""
        high, wide = (cells * self.resolution_m for cells in self.cells.shape)
        ends = ((0.0, 0.0), (wide, 0.0), (wide, high), (0.0, high))
        return [to_map(end, self.origin) for end in ends]
