"""What bodies tell of themselves and their world, from what they know at that moment."""

import math
from typing import Any

import numpy as np
import pytest
from support.bodies import Teller

from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.core.cancel import CancelToken
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.facts import battery_skill, facts_of, known_of
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.panda.skills import table_facts

SPEED_M_S = 0.8
ON = {"x": 0.5, "y": 0.0, "z": 0.025}


class Goal:
    """A goal that nobody cancels."""

    token = CancelToken()


def told(body: Any, fact: str, **arguments: str) -> dict[str, Any]:
    one = next(one for one in facts_of(body) if one.name == fact)
    return dict(one.function(Goal(), **arguments))


class Lidar(Teller):
    """A body that only measures distances: so far at these bearings, in degrees."""

    def __init__(self, **at: float) -> None:
        super().__init__(SkillSet(()))
        self._at = {int(name.removeprefix("at")): range_m for name, range_m in at.items()}

    def scan(self) -> LidarScan:
        ranges = np.full(360, math.inf, np.float32)
        for bearing, range_m in self._at.items():
            ranges[bearing + 180] = range_m
        return LidarScan(0.0, -math.pi, math.radians(1.0), 0.05, 10.0, ranges)


class Lost(ApartmentRobot):
    """A robot that does not know where it is."""

    def pose(self) -> Pose2D:
        raise SkillFailed("I do not know where I am.")


class Driving(ApartmentRobot):
    """A robot that says it drives so fast."""

    def __init__(self, twist: Twist2D) -> None:
        super().__init__()
        self._twist = twist

    def velocity(self) -> Twist2D:
        return self._twist


def test_a_place_is_as_far_as_the_way_there_and_not_as_the_straight_line():
    body = ApartmentRobot()
    found, pose, point = told(body, "how_far", room="office"), body.pose(), body.places["office"]

    assert found["distance"] > math.dist((pose.x_m, pose.y_m), point)
    assert found["takes_s"] >= found["distance"] / SPEED_M_S


def test_the_nearest_place_is_the_one_with_the_shortest_way_besides_where_it_is():
    body = ApartmentRobot()
    ways = {name: told(body, "how_far", room=name).get("distance") for name in body.places}
    found = told(body, "nearest_place")

    assert found["here"] == "living_room"
    assert found["distance"] == min(way for way in ways.values() if way is not None)
    assert ways["living_room"] is None


def test_where_it_is_and_is_not():
    body = ApartmentRobot()

    assert told(body, "are_you_in", room="living_room")["yes"]
    assert told(body, "are_you_in", room="kitchen")["no"]
    assert told(body, "are_you_in", room="kitchen")["here"] == "living_room"
    assert told(body, "which_way", room="kitchen")["side"] == "to_my_right"  # it looks north


def test_a_place_that_it_was_taught_is_as_far_as_any():
    body = ApartmentRobot()
    body.place_memory.remember("charger", Pose2D(4.3, 1.75, 0.0), "map")

    assert told(body, "how_far", room="charger")["distance"] == pytest.approx(1.0, abs=0.01)
    assert told(body, "which_places")["names"][-1] == "charger"
    assert told(body, "nearest_place")["room"] == "charger"


@pytest.mark.parametrize("fact", ["how_far", "which_way", "are_you_in"])
def test_a_robot_that_is_lost_says_of_no_place_where_it_is(fact):
    assert told(Lost(), fact, room="kitchen").keys() <= {"room"}


def test_a_robot_that_is_lost_knows_its_places_but_not_which_is_nearest():
    assert told(Lost(), "nearest_place") == {}
    assert told(Lost(), "which_places")["count"] == 4


@pytest.mark.parametrize(
    ("twist", "known"),
    [
        (Twist2D(0.5, 0.0), {"speed": 0.5}),
        (Twist2D(-0.3, 1.0), {"speed": 0.3}),
        (Twist2D(0.0, 1.0), {"turning": True, "still": False}),
        (Twist2D(0.001, 0.0), {"turning": False, "still": True}),
    ],
)
def test_how_fast_it_is(twist, known):
    assert told(Driving(twist), "how_fast") == known


def test_what_is_ahead_is_what_stands_in_the_lane_and_not_beside_it():
    assert told(Lidar(at0=3.0, at90=0.4), "what_is_ahead")["distance"] == pytest.approx(3.0)
    assert told(Lidar(at5=2.0, at0=3.0), "what_is_ahead")["distance"] == pytest.approx(
        1.99, abs=0.01
    )
    assert told(Lidar(at45=1.0), "what_is_ahead") == {"free": 10.0}


def test_what_is_around_is_the_nearest_thing_on_any_side():
    assert told(Lidar(at0=3.0, at90=0.4), "what_is_around") == {
        "distance": pytest.approx(0.4),
        "side": "to_my_left",
    }
    assert told(Lidar(), "what_is_around") == {"free": 10.0}


def test_a_body_tells_nothing_that_it_has_no_sense_for():
    body = Teller(SkillSet(()))

    assert told(body, "what_is_ahead") == told(body, "how_fast") == told(body, "battery") == {}
    assert told(body, "which_places") == {"names": [], "count": 0}
    assert not any(told(body, "what_do_you_see").values())


def test_what_is_left_of_the_way_is_known_only_while_it_is_on_one():
    assert known_of(ApartmentRobot()).way_left() is None


def test_a_battery_lasts_longer_the_fuller_it_is():
    body = ApartmentRobot()
    found = battery_skill(body).function(Goal())

    assert found["lasts_s"] == round(body.battery_lasts_s())
    assert 3600 < found["lasts_s"] < 4 * 3600


class Table:
    """Three cubes: one in the hand, one in a bin, one on the table."""

    def describe_hand(self) -> dict[str, Any]:
        return {**ON, "z": 0.325, "held": "blue_cube"}

    def describe_objects(self) -> dict[str, Any]:
        places = {"red_cube": "left_bin", "green_cube": "table", "blue_cube": "hand"}
        return {"objects": {name: {**ON, "on": place} for name, place in places.items()}}


def on_table(fact: str, **arguments: str) -> dict[str, Any]:
    one = next(one for one in table_facts(Table()) if one.name == fact)
    return dict(one.function(Goal(), **arguments))


def test_where_each_cube_is():
    assert on_table("where_is", object="red_cube")["place"] == "left_bin"
    assert on_table("is_it_there", object="red_cube", target="left_bin")["yes"]
    assert on_table("is_it_there", object="green_cube", target="left_bin")["no"]


def test_what_is_in_a_bin_and_on_the_table():
    assert [*on_table("what_is_there", target="left_bin")["objects"]] == ["red_cube"]
    assert on_table("what_is_there", target="right_bin")["objects"] == {}
    assert [*on_table("what_is_in_bins")["objects"]] == ["red_cube"]


def test_what_the_hand_holds_is_not_near_it():
    assert on_table("how_far_is_thing", object="blue_cube")["held"]
    assert on_table("how_far_is_thing", object="green_cube")["distance"] == pytest.approx(0.3)
    assert on_table("nearest_thing")["object"] in {"red_cube", "green_cube"}
