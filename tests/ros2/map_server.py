"""A map server, as a process: plain rclpy, nothing of edgevox imported.

    python map_server.py --namespace /robot1 --topic map --frame map

Publishes a room of 6 by 4 m once, as Nav2's does: reliable, kept for whoever comes later unless
it is ``--volatile``. Its lower left corner is at (-1, -2). A string on ``do`` publishes another:
``wall`` with a column that is occupied, too, or a lie: ``short`` (a cell is missing), ``nowhere``
(its origin is no number).
"""

import argparse
import contextlib
import math

import rclpy
from nav_msgs.msg import OccupancyGrid
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

COLUMNS, ROWS, CELL_M = 60, 40, 0.1
AROUND = 5
"""So many cells around the room nobody knows."""


class MapServer(Node):
    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__("map_server", namespace=options.namespace)
        self.frame = options.frame
        quality = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=(
                DurabilityPolicy.VOLATILE if options.volatile else DurabilityPolicy.TRANSIENT_LOCAL
            ),
        )
        self.map = self.create_publisher(OccupancyGrid, options.topic, quality)
        self.create_subscription(String, "do", self.change, 10)
        self.map.publish(self.room())

    def change(self, message: String) -> None:
        word, _, column = message.data.partition(" ")
        room = self.room(int(column) if word == "wall" else None)
        if word == "short":
            room.data = room.data[:-1]
        elif word == "nowhere":
            room.info.origin.position.x = math.nan
        self.map.publish(room)

    def room(self, column: int | None = None) -> OccupancyGrid:
        rows = []
        for y in range(-AROUND, ROWS + AROUND):
            for x in range(-AROUND, COLUMNS + AROUND):
                edge = x in (0, COLUMNS - 1) or y in (0, ROWS - 1) or x == column
                inside = 0 <= x < COLUMNS and 0 <= y < ROWS
                rows.append((100 if edge else 0) if inside else -1)
        message = OccupancyGrid(data=rows)
        message.header.frame_id = self.frame
        message.info.width, message.info.height = COLUMNS + 2 * AROUND, ROWS + 2 * AROUND
        message.info.resolution = CELL_M
        message.info.origin.position.x = -1.0 - AROUND * CELL_M
        message.info.origin.position.y = -2.0 - AROUND * CELL_M
        return message


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--namespace", default="/")
    parser.add_argument("--topic", default="map")
    parser.add_argument("--frame", default="map")
    parser.add_argument("--volatile", action="store_true")
    options = parser.parse_args()
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        server = MapServer(options)
        while rclpy.ok():
            rclpy.spin_once(server, timeout_sec=1.0)  # a wake-up may be lost


if __name__ == "__main__":
    main()
