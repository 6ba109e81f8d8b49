"""The views of Foxglove, PlotJuggler and RViz show topics that there are, as what they are.

Nobody opened them here: that each panel looks as meant is not tested. That none waits for a topic
which no robot has, or of another type, or by a quality of service that nobody offers, is.
"""

import importlib
import json
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
import yaml

from edgevox.core.transforms import MAP, ODOM
from edgevox.ros2.contract import DIAGNOSTICS, NODE_NAME, PUBLISHED, SUBSCRIBED
from edgevox.ros2.standard_topics import EXTERNAL, INTEROP

ROOT = Path(__file__).parents[3]
TOLD = ROOT / "scripts" / "docs" / "told.toml"
TOPICS = tomllib.loads(TOLD.read_text(encoding="utf-8"))["topics"]
"""The standard topics of each robot, as docs/robots.md shows them."""
ROBOTS = ("robot-apartment", "robot-external", "robot-humanoid", "robot-panda")
"""robot-irsim is the same robot as robot-apartment, by its topics too."""

PANELS = {
    "3D": ("topics",),
    "DiagnosticSummary": ("topicToRender",),
    "Image": ("imageTopic", "calibrationTopic"),
    "Plot": ("value",),
    "Publish": ("topicName",),
    "RawMessages": ("topicPath",),
    "StateTransitions": ("value",),
}
"""Kinds of Foxglove's and Lichtblick's panels, and what in them names topics."""
DISPLAYS = {
    "Image": "sensor_msgs/msg/Image",
    "LaserScan": "sensor_msgs/msg/LaserScan",
    "Map": "nav_msgs/msg/OccupancyGrid",
    "Odometry": "nav_msgs/msg/Odometry",
    "Pose": "geometry_msgs/msg/PoseStamped",
    "SetGoal": "geometry_msgs/msg/PoseStamped",
}
"""RViz's displays and tools, and what each takes."""


def _offered(robot: str) -> dict[str, Any]:
    """The rows of the contract that a robot has, by their names on the wire."""
    rows = {f"/{NODE_NAME}/{row.topic}": row for row in (*PUBLISHED, *SUBSCRIBED)}
    rows[DIAGNOSTICS.topic] = DIAGNOSTICS
    if robot == "robot-external":
        return rows | {f"/{row.topic}": row for row in EXTERNAL}
    has = TOPICS[robot.removeprefix("robot-")]
    return rows | {f"/{NODE_NAME}/{row.topic}": row for row in INTEROP if row.topic in has}


def _foxglove(robot: str) -> dict[str, Any]:
    text = (ROOT / "examples" / "foxglove" / f"{robot}.json").read_text(encoding="utf-8")
    return json.loads(text)


def _rviz(robot: str) -> dict[str, Any]:
    text = (ROOT / "examples" / "rviz" / f"{robot}.rviz").read_text(encoding="utf-8")
    return yaml.safe_load(text)["Visualization Manager"]


def _values(tree: Any, names: tuple[str, ...]) -> Iterator[str]:
    """What stands under these names, however deep; of a mapping its keys."""
    if isinstance(tree, Mapping):
        for name, value in tree.items():
            if name in names:
                yield from value if isinstance(value, Mapping) else (value,)
            else:
                yield from _values(value, names)
    elif isinstance(tree, list):
        for one in tree:
            yield from _values(one, names)


def _with_topics(robot: str) -> list[tuple[str, Mapping[str, Any]]]:
    """RViz's displays and tools that name a topic: the class, and the topic's mapping."""
    manager = _rviz(robot)
    every = (*manager["Displays"], *manager["Tools"])
    return [(one["Class"].partition("/")[2], one["Topic"]) for one in every if "Topic" in one]


def _leaves(tree: Any) -> list[str]:
    if isinstance(tree, str):
        return [tree]
    assert tree["direction"] in {"row", "column"}
    return _leaves(tree["first"]) + _leaves(tree["second"])


def _has(row: Any, path: list[str]) -> bool:
    """Whether a message of the topic, in one of its types, has a number or text there."""
    for type_ in getattr(row, "types", (row.type,)):
        package, _, name = type_.split("/")
        value = getattr(importlib.import_module(f"{package}.msg"), name)()
        for part in path:
            value = getattr(value, part, None)
        if isinstance(value, (int, float, str)):
            return True
    return False


@pytest.mark.parametrize("folder", ["foxglove", "plotjuggler", "rviz"])
def test_each_robot_has_a_view(folder):
    assert {one.stem for one in (ROOT / "examples" / folder).iterdir()} == set(ROBOTS)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_layout_of_foxglove_shows_each_of_its_panels_once(robot):
    layout = _foxglove(robot)
    assert sorted(_leaves(layout["layout"])) == sorted(layout["configById"])


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_foxglove_shows_is_a_topic_that_the_robot_has(robot):
    offered = _offered(robot)
    for panel, config in _foxglove(robot)["configById"].items():
        named = list(_values(config, PANELS[panel.partition("!")[0]]))
        assert named, panel
        for path in named:
            topic, _, field = path.partition(".")
            assert topic in offered, f"{panel}: {path}"
            assert not field or _has(offered[topic], field.split(".")), f"{panel}: {path}"


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_plotjuggler_draws_is_a_number_of_a_topic_that_it_subscribes_to(robot):
    root = ET.parse(ROOT / "examples" / "plotjuggler" / f"{robot}.xml").getroot()  # noqa: S314
    subscribed = root.find("Plugins/plugin/selected_topics").attrib["value"].split(";")
    offered = {topic: _offered(robot)[topic] for topic in subscribed}
    curves = [one.attrib["name"] for one in root.iter("curve")]
    assert curves
    for curve in curves:
        (topic,) = [one for one in subscribed if curve.startswith(f"{one}/")]
        assert _has(offered[topic], curve.removeprefix(f"{topic}/").split("/")), curve


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_foxglove_sends_is_what_the_robot_takes(robot):
    """Words and the stop, by way of EdgeVox: nothing goes past it to the robot's own topics."""
    taken = {name: row for name, row in _offered(robot).items() if _comes_in(row)}
    for panel, config in _foxglove(robot)["configById"].items():
        if panel.startswith("Publish!"):
            row = taken[config["topicName"]]
            assert config["datatype"] == row.type
            assert json.loads(config["value"]).keys() == {"data"}
        goal = config.get("publish", {}).get("poseTopic")
        assert goal is None or taken[goal].type == "geometry_msgs/msg/PoseStamped"


def _comes_in(row: Any) -> bool:
    """Whether EdgeVox itself takes it. A robot's own `goal_pose` is EdgeVox's to write."""
    return row in SUBSCRIBED or (row in INTEROP and row.direction == "in")


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_rviz_shows_is_a_topic_of_that_type(robot):
    offered = _offered(robot)
    shown = _with_topics(robot)
    assert shown
    for kind, topic in shown:
        assert offered[topic["Value"]].type == DISPLAYS[kind]
        assert kind != "SetGoal" or _comes_in(offered[topic["Value"]])


@pytest.mark.parametrize("robot", ROBOTS)
def test_rviz_asks_for_no_more_than_is_offered(robot):
    """A subscriber that wants every message gets none from a publisher that may lose some."""
    offered = _offered(robot)
    for kind, topic in _with_topics(robot):
        row = offered[topic["Value"]]
        qos = getattr(row.qos, "value", row.qos)
        if kind != "SetGoal":
            kept = topic["Durability Policy"] == "Transient Local"
            assert kept is (kind == "Map")
            assert qos.transient_local or not kept
            assert qos.reliable or topic["Reliability Policy"] == "Best Effort"


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_fixed_frame_is_one_that_the_robot_hangs_from(robot):
    frame = ODOM if robot == "robot-external" else MAP
    assert _rviz(robot)["Global Options"]["Fixed Frame"] == frame
    followed = [
        one["followTf"] for one in _foxglove(robot)["configById"].values() if "scene" in one
    ]
    assert followed == [frame]
