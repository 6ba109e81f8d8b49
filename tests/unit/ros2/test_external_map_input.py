"""The occupancy grid of a robot, as its map server sends it, or as somebody does who means harm."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose, Quaternion
from nav_msgs.msg import MapMetaData, OccupancyGrid
from rclpy.serialization import serialize_message

from edgevox.core.errors import InvalidValue
from edgevox.robots.capabilities import FREE, OCCUPIED, UNKNOWN
from edgevox.ros2.external.inputs import MOST_CELLS, MOST_SHOWN, MapInput, map_of
from edgevox.ros2.external.topic_types import TopicTypes


def grid(values: np.ndarray, resolution: float = 0.5, **origin: float) -> OccupancyGrid:
    rows, columns = values.shape
    position = Point(x=origin.get("x", 0.0), y=origin.get("y", 0.0))
    yaw = origin.get("yaw", 0.0)
    turn = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    info = MapMetaData(
        width=columns,
        height=rows,
        resolution=resolution,
        origin=Pose(position=position, orientation=turn),
    )
    return OccupancyGrid(info=info, data=values.astype(np.int8).ravel().tolist())


def test_cells_are_what_the_map_server_means_by_them():
    values = np.array([[0, 25, 26, 64, 65, 100, -1, 101, -128]])
    kinds = [FREE, FREE, UNKNOWN, UNKNOWN, OCCUPIED, OCCUPIED]  # what follows is cropped
    assert map_of(grid(values)).cells.tolist() == [kinds]


def test_its_origin_and_the_way_that_it_is_turned_count():
    values = np.full((4, 6), -1)
    values[1, 2] = 100
    heard = map_of(grid(values, x=3.0, y=4.0, yaw=math.pi / 2))
    assert heard.cells.tolist() == [[OCCUPIED]]
    assert (heard.origin.x_m, heard.origin.y_m) == pytest.approx((2.5, 5.0))
    assert heard.origin.yaw_rad == pytest.approx(math.pi / 2)


def test_a_large_one_is_kept_no_finer_than_it_is_shown():
    values = np.zeros((1000, 2000))
    values[999, 1999] = 100
    heard = map_of(grid(values, 0.05))
    assert heard.cells.shape == (250, 500)
    assert max(heard.cells.shape) <= MOST_SHOWN
    assert heard.resolution_m == pytest.approx(0.2)
    assert heard.cells[-1, -1] == OCCUPIED


def test_of_one_that_knows_nothing_nothing_is_kept():
    assert map_of(grid(np.full((3, 3), -1))).cells.size == 0


@pytest.mark.parametrize(
    ("changed", "field"),
    [
        ({"width": 0}, "info"),
        ({"height": 0}, "info"),
        ({"width": 2**32 - 1, "height": 2**32 - 1}, "info"),
        ({"width": MOST_CELLS + 1, "height": 1}, "info"),
        ({"width": 3}, "data"),
        ({"height": 4}, "data"),
        ({"resolution": 0.0}, "info.resolution"),
        ({"resolution": -0.05}, "info.resolution"),
        ({"resolution": math.nan}, "info.resolution"),
        ({"resolution": math.inf}, "info.resolution"),
        ({"resolution": 1e-9}, "info.resolution"),
        ({"resolution": 1e6}, "info.resolution"),
        ({"origin": Pose(position=Point(x=math.nan))}, "info.origin"),
        ({"origin": Pose(position=Point(y=math.inf))}, "info.origin"),
        ({"origin": Pose(position=Point(x=1e9))}, "info.origin"),
        ({"origin": Pose(orientation=Quaternion(w=0.0))}, "info.origin"),
        ({"origin": Pose(orientation=Quaternion(w=math.nan))}, "info.origin"),
        ({"origin": Pose(orientation=Quaternion(x=1.0, w=0.0))}, "info.origin"),
        ({"origin": Pose(orientation=Quaternion(w=3.0))}, "info.origin"),
    ],
)
def test_what_cannot_be_a_map_is_refused_by_field(changed: dict, field: str) -> None:
    message = grid(np.zeros((2, 4)))
    for name, value in changed.items():
        setattr(message.info, name, value)
    with pytest.raises(InvalidValue) as refused:
        map_of(message)
    assert refused.value.field == f"map: {field}"


class HeardNode:
    """Stands for a node; what a test publishes is heard by all its subscriptions, one by one."""

    def __init__(self) -> None:
        self._hear: list = []
        self._sent_ns = 0

    def resolve_topic_name(self, topic: str) -> str:
        return f"/{topic}"

    def get_publishers_info_by_topic(self, _topic) -> list:
        return []

    def create_subscription(self, _type, _topic, callback, quality, **_) -> None:
        self._hear.append((callback, quality))

    @property
    def durabilities(self) -> set[str]:
        return {quality.durability.name for _, quality in self._hear}

    def publish(self, data: bytes) -> None:
        self._sent_ns += 1
        for callback, _ in self._hear:
            callback(data, {"source_timestamp": self._sent_ns})


@pytest.mark.parametrize(
    "lie",
    [
        serialize_message(grid(np.zeros((2, 4)), math.nan)),
        b"no map",
        bytes(MOST_CELLS + 5000),
    ],
    ids=["impossible", "no message", "too large"],
)
def test_what_is_no_map_takes_none_away_also_before_anybody_looks(lie: bytes) -> None:
    node = HeardNode()
    heard = MapInput(node, TopicTypes(node))
    for columns in (4, 7):
        node.publish(serialize_message(grid(np.zeros((2, columns)))))
        node.publish(lie)
        newest = heard.newest()
        assert newest is not None
        assert newest[0].cells.shape == (2, columns)
    assert heard.refused == 2


def test_one_that_is_heard_both_ways_is_made_once() -> None:
    node = HeardNode()
    heard = MapInput(node, TopicTypes(node))
    assert node.durabilities == {"TRANSIENT_LOCAL", "VOLATILE"}
    node.publish(serialize_message(grid(np.zeros((2, 4)))))
    first = heard.newest()
    assert heard.newest() is first
