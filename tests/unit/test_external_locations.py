"""A locations file says where places are; what is wrong in it is said by name."""

import math
from pathlib import Path

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import LARGEST_TEXT_BYTES
from edgevox.ros2.external.locations import Location, load_locations, parse_locations

EXAMPLE = Path(__file__).parents[2] / "examples" / "ros2" / "locations.yaml"


def refused(text: str) -> InvalidValue:
    with pytest.raises(InvalidValue) as caught:
        parse_locations(text, "home.yaml")
    return caught.value


def test_the_example_is_a_locations_file() -> None:
    locations = load_locations(EXAMPLE)

    assert list(locations) == ["dock", "desk", "front_door"]
    assert locations["dock"] == Location(0.0, 0.0, 3.1416, ("home", "charger"))
    assert locations["front_door"].yaw_rad is None


@pytest.mark.parametrize(
    ("text", "field", "expected"),
    [
        ("", "home.yaml", "a mapping"),
        ("{}", "home.yaml", "1 to 200"),
        ("- dock", "home.yaml", "a mapping"),
        ("dock: [1, 2]", "home.yaml:1: dock", "a mapping"),
        ("dock:", "home.yaml:1: dock", "a mapping"),
        ("dock: {x: 1}", "home.yaml:1: dock.y", "metres"),
        ("dock: {x: 1, y: far}", "home.yaml:1: dock.y", "a number"),
        ("dock: {x: 1, y: .nan}", "home.yaml:1: dock.y", "a finite number"),
        ("dock: {x: 1, y: 123456.0}", "home.yaml:1: dock.y", "a number from -10000 to 10000"),
        ("dock: {x: 1, y: true}", "home.yaml:1: dock.y", "a number"),
        ("dock: {x: 1, y: 2, yaw: 90}", "home.yaml:1: dock.yaw", "-6.28319 to 6.28319"),
        ("dock: {x: 1, y: 2, yawn: 1}", "home.yaml:1: dock.yawn", "did you mean 'yaw'?"),
        (
            "dock: {x: 1, y: 2, speed: 1}",
            "home.yaml:1: dock.speed",
            "one of aliases, names, x, y, yaw",
        ),
        ("dock: {x: 1, y: 2, aliases: home}", "home.yaml:1: dock.aliases", "a list of texts"),
        ("dock: {x: 1, y: 2, aliases: ['[home]']}", "home.yaml:1: dock.aliases.0", "a name"),
        ("'(dock|desk)': {x: 1, y: 2}", "home.yaml:1: (dock|desk)", "a name"),
        ("1: {x: 1, y: 2}", "home.yaml:1: 1", "a name"),
        ("'': {x: 1, y: 2}", "home.yaml:1: ", "a name"),
        (f"{'d' * 41}: {{x: 1, y: 2}}", f"home.yaml:1: {'d' * 41}", "a name"),
        (
            "front_door: {x: 1, y: 2}\nFront Door: {x: 3, y: 4}",
            "home.yaml:2: Front Door",
            "does not",
        ),
        ("dock: {x: 1, y: 2}\ndesk: {x: 3, y: 4, aliases: [dock]}", "home.yaml:2: desk", "'dock'"),
        ("dock: {x: 1, y: 2", "home.yaml", "valid YAML"),
    ],
)
def test_what_is_wrong_is_said_by_its_field(text: str, field: str, expected: str) -> None:
    error = refused(text)

    assert error.field == field
    assert expected in error.expected


def test_a_file_has_a_size_that_fits_a_home(tmp_path) -> None:
    many = "".join(f"place{n}: {{x: {n}, y: 0}}\n" for n in range(201))
    assert "1 to 200" in refused(many).expected

    big = tmp_path / "big.yaml"
    big.write_text("#" * (LARGEST_TEXT_BYTES + 1))
    with pytest.raises(InvalidValue, match="locations: .* at most 1000000 bytes"):
        load_locations(big)


def test_a_file_that_is_not_there_is_said(tmp_path) -> None:
    with pytest.raises(InvalidValue, match="locations: got .*nowhere.yaml.*No such file"):
        load_locations(tmp_path / "nowhere.yaml")


def test_a_whole_turn_is_a_yaw() -> None:
    (one,) = parse_locations(f"dock: {{x: 0, y: 0, yaw: {math.tau}}}", "home.yaml").values()

    assert one.yaw_rad == pytest.approx(math.tau)
