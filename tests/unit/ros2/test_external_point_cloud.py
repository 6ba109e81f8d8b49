"""A point cloud as a sweep: what stands in the robot's way, and which directions are not seen."""

import math

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose3D
from edgevox.robots.relative_motion import blocked, sees
from edgevox.ros2.external.sensors import points_of, scan_of

ABOVE = Pose3D(0.2, 0.0, 0.5)
"""A sensor that looks ahead, half a metre up."""
NEAREST_M = 0.3


def cloud(points, *, order: str = "<", kind: str = "f4", rows: int = 1, padding: int = 0):
    """These points, each with a brightness before it, in rows that end with padding."""
    datatype = PointField.FLOAT32 if kind == "f4" else PointField.FLOAT64
    size = np.dtype(kind).itemsize
    table = np.zeros((len(points), 4), f"{order}{kind}")
    table[:, 1:] = points
    step, width = 4 * size, len(points) // rows
    data = table.view(np.uint8).reshape(rows, width * step)
    data = np.pad(data, ((0, 0), (0, padding)))
    return PointCloud2(
        fields=[
            PointField(name=name, offset=at * size, datatype=datatype, count=1)
            for at, name in enumerate(("intensity", "x", "y", "z"))
        ],
        is_bigendian=order == ">",
        point_step=step,
        row_step=width * step + padding,
        height=rows,
        width=width,
        data=data.tobytes(),
    )


POINTS = [(1.0, 2.0, 3.0), (-1.5, 0.25, 0.5), (4.0, -4.0, 0.0), (9.0, 8.0, 7.0)]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", ["f4", "f8"])
@pytest.mark.parametrize(("rows", "padding"), [(1, 0), (2, 0), (2, 12)])
def test_points_are_read_whatever_their_layout(order, kind, rows, padding):
    read = points_of(cloud(POINTS, order=order, kind=kind, rows=rows, padding=padding))
    assert (read == np.array(POINTS)).all()


def test_a_point_at_the_robots_height_blocks_it_and_the_floor_and_the_ceiling_do_not():
    wall, floor, ceiling = (0.6, 0.0, 0.0), (0.6, 0.0, -0.5), (0.6, 0.0, 1.8)

    assert blocked(scan_of(cloud([wall]), ABOVE, NEAREST_M), 1.0, 0.3)
    assert not blocked(scan_of(cloud([wall]), ABOVE, NEAREST_M), 0.75, 0.3)  # it is at 0.8 m
    assert not blocked(scan_of(cloud([floor, ceiling]), ABOVE, NEAREST_M), 1.0, 0.3)


def test_the_nearest_point_of_a_direction_counts_and_the_robot_itself_does_not():
    itself, near, far = (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (3.0, 0.0, 0.0)

    scan = scan_of(cloud([far, near, itself, (math.nan, 0.0, 0.0)]), ABOVE, NEAREST_M)

    assert np.nanmin(scan.ranges_m) == pytest.approx(0.7)


def test_a_direction_without_any_point_is_not_seen():
    angles = np.radians(np.arange(-40, 40, 0.5))
    ahead = np.stack([np.cos(angles), np.sin(angles), -0.5 + 0 * angles], axis=1)

    scan = scan_of(cloud(ahead), Pose3D(0.0, 0.0, 0.5), NEAREST_M)

    assert sees(scan)
    assert not sees(scan, behind=True)


@pytest.mark.parametrize(
    ("changed", "field"),
    [({"fields": []}, "fields"), ({"data": b"abc"}, "data"), ({"point_step": 1}, "data")],
)
def test_a_cloud_that_cannot_be_read_is_refused_by_field(changed, field):
    message = cloud(POINTS)
    for name, value in changed.items():
        setattr(message, name, value)
    with pytest.raises(InvalidValue) as refused:
        scan_of(message, ABOVE, NEAREST_M)
    assert refused.value.field == field
