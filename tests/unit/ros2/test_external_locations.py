"""A locations file says where places are. Wrong ones: tests/wrong/locations."""

import math
from pathlib import Path

import pytest

from edgevox.ros2.external.settings import Location, load_locations, parse_locations

EXAMPLE = Path(__file__).parents[3] / "examples" / "ros2" / "locations.yaml"


def test_the_example_is_a_locations_file() -> None:
    locations = load_locations(EXAMPLE)

    assert list(locations) == ["dock", "desk", "front_door"]
    assert locations["dock"] == Location(0.0, 0.0, 3.1416, ("home", "charger"))
    assert locations["front_door"].yaw_rad is None


def test_a_whole_turn_is_a_yaw() -> None:
    (one,) = parse_locations(f"dock: {{x: 0, y: 0, yaw: {math.tau}}}", "home.yaml").values()

    assert one.yaw_rad == pytest.approx(math.tau)
