"""Limits hold for whatever moves: when, where to, how far, how fast."""

import math
from datetime import datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.policy import Policy, PolicyContext, Rule
from edgevox.agent.policy.policy import parse_policy
from edgevox.core.commands import Way
from edgevox.core.transforms import Pose2D

SPEEDS = st.floats(min_value=-1e9, max_value=1e9)
PLACES = {"kitchen": (8.0, 2.0), "living_room": (2.0, 2.0)}
MONDAY = datetime(2026, 11, 23)  # noqa: DTZ001 - the wall's clock


def rooms(x_m, _y_m):
    """The kitchen is right of x 5, the living room left of x 4; a corridor is between."""
    return "kitchen" if x_m > 5 else "living_room" if x_m < 4 else None


AROUND = PolicyContext(lambda: PLACES, rooms, lambda: Pose2D(2.0, 2.0, 0.0))


def policy(limits, rules="{}"):
    return Policy(parse_policy(f"rules: {rules}\nlimits: {limits}", "p.yaml"))


def judged(limits, skill, around=AROUND, now=MONDAY, **arguments):
    """The code that a skill is refused with; empty if it is done."""
    verdict = policy(limits).judge(Way.VOICE, skill, arguments, around=around, now=now)
    assert verdict.rule is (Rule.DENY if verdict.reason else Rule.ALLOW)
    return verdict.reason.code


@pytest.mark.parametrize(
    ("limits", "arguments", "code"),
    [
        ("{places: {never: [kitchen]}}", {"room": "kitchen"}, "policy_place"),
        ("{places: {never: [Living Room]}}", {"room": "living_room"}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"room": "living_room"}, ""),
        ("{places: {only: [kitchen]}}", {"location": "living_room"}, "policy_place"),
        ("{places: {only: [kitchen]}}", {"room": "kitchen"}, ""),
        ("{places: {only: [kitchen], never: [kitchen]}}", {"room": "kitchen"}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"x": 8.0, "y": 2.0}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"x": 4.5, "y": 2.0}, ""),
        ("{places: {only: [kitchen]}}", {"x": 4.5, "y": 2.0}, "policy_nowhere"),
        ("{places: {only: [kitchen]}}", {"x": 8.0, "y": 2.0}, ""),
        (
            "{places: {never: [left_bin]}}",
            {"object": "red_cube", "target": "left_bin"},
            "policy_place",
        ),
        ("{places: {never: [kitchen]}}", {"rounds": ["living_room", "Kitchen"]}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"text": "say kitchen"}, ""),
    ],
)
def test_a_place_is_refused_by_its_name_and_by_a_point_in_it(limits, arguments, code):
    assert judged(limits, "go", **arguments) == code


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"x": 5.0, "y": 2.0}, ""),
        ({"x": 7.01, "y": 2.0}, "policy_distance"),
        ({"room": "living_room"}, ""),
        ({"room": "kitchen"}, "policy_distance"),
        ({"distance": 5.0}, ""),
        ({"distance": 5.01}, "policy_distance"),
        ({"distance": -5.01}, "policy_distance"),
        ({"degrees": 720.0}, ""),
        ({}, ""),
    ],
)
def test_a_walk_and_the_goal_of_a_drive_are_so_far_at_most(arguments, code):
    assert judged("{distance_m: 5}", "go", **arguments) == code


def test_who_does_not_know_where_it_is_drives_nowhere_where_a_distance_is_limited():
    lost = PolicyContext(lambda: PLACES, rooms)
    assert judged("{distance_m: 5}", "go", lost, room="kitchen") == "policy_lost"
    assert judged("{distance_m: 5}", "go", lost, distance=1.0) == ""
    assert judged("{}", "go", lost, room="kitchen") == ""


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"x": 0.0, "y": 5.0}, ""),
        ({"x": -0.01, "y": 2.0}, "policy_area"),
        ({"x": 3.0, "y": 5.01}, "policy_area"),
        ({"room": "kitchen"}, "policy_area"),
        ({"room": "living_room"}, ""),
        ({"x": 0.3, "y": -9.0, "z": 0.2}, ""),
        ({"x": 0.3, "y": 0.0, "z": 0.04}, "policy_area"),
        ({"x": 0.7, "y": 0.0, "z": 0.2}, "policy_area"),
    ],
)
def test_goals_on_the_floor_and_points_for_the_hand_have_a_box_each(arguments, code):
    limits = "{goals: {x: {min: 0, max: 5}, y: {max: 5}}, hand: {x: {max: 0.5}, z: {min: 0.05}}}"
    assert judged(limits, "go", **arguments) == code


DAY = "{from: '07:00', to: '19:00', days: [mon]}"
NIGHT = "{from: '22:00', to: '02:00', days: [mon]}"
ALWAYS = "{from: '00:00', to: '24:00', days: [mon]}"


@pytest.mark.parametrize(
    ("hours", "day", "clock", "open_"),
    [
        (DAY, 0, "06:59", False),
        (DAY, 0, "07:00", True),
        (DAY, 0, "18:59", True),
        (DAY, 0, "19:00", False),
        (DAY, 1, "12:00", False),
        (NIGHT, 0, "01:00", False),
        (NIGHT, 0, "22:00", True),
        (NIGHT, 1, "01:59", True),
        (NIGHT, 1, "02:00", False),
        (NIGHT, 1, "22:00", False),
        (ALWAYS, 0, "00:00", True),
        (ALWAYS, 0, "23:59", True),
        (ALWAYS, 1, "00:00", False),
        (f"{DAY}, {NIGHT}", 0, "23:00", True),
        ("{from: '07:30', to: '19:30'}", 6, "19:29", True),
        ("{from: '07:30', to: '19:30'}", 6, "19:30", False),
        ("{from: '22:00', to: '02:00', days: [sun]}", 0, "01:00", True),
    ],
)
def test_it_moves_only_in_its_hours_also_across_midnight(hours, day, clock, open_):
    hour, minute = map(int, clock.split(":"))
    now = MONDAY + timedelta(days=day, hours=hour, minutes=minute)
    limits = f"{{hours: [{hours}]}}"
    assert judged(limits, "go", now=now) == ("" if open_ else "policy_hours")
    assert bool(policy(limits).steered(now)) is not open_


def test_a_limit_is_for_what_moves_and_never_for_a_stop():
    night = policy(f"{{hours: [{DAY}], places: {{never: [kitchen]}}}}", "{'*': deny}")
    assert night.judge(Way.VOICE, "stop", {}, now=MONDAY).rule is Rule.ALLOW
    night = policy(f"{{hours: [{DAY}], places: {{never: [kitchen]}}}}")
    about = {"room": "kitchen"}
    looks = night.judge(Way.VOICE, "look", about, moves=False, around=AROUND, now=MONDAY)
    assert looks.rule is Rule.ALLOW


@given(SPEEDS, SPEEDS)
def test_a_velocity_is_slowed_to_the_limit_on_the_same_arc(linear, angular):
    permitted = policy("{speed: {linear_m_s: 0.3, angular_rad_s: 0.6}}").slowed(linear, angular)
    assert abs(permitted[0]) <= 0.3 * (1 + 1e-9)
    assert abs(permitted[1]) <= 0.6 * (1 + 1e-9)
    assert permitted[0] * angular == pytest.approx(permitted[1] * linear, rel=1e-6, abs=1e-9)
    if abs(linear) <= 0.3 and abs(angular) <= 0.6:
        assert permitted == (linear, angular)


def test_one_speed_may_be_limited_alone():
    assert policy("{speed: {angular_rad_s: 0.5}}").slowed(9.0, 0.5) == (9.0, 0.5)
    assert policy("{speed: {angular_rad_s: 0.5}}").slowed(8.0, -1.0) == (4.0, -0.5)


TAUGHT = {"nest": (8.0, 2.0), "corner": (1.0, 1.0), "gap": (4.5, 2.0)}
TOLD = PolicyContext(lambda: PLACES, rooms, lambda: Pose2D(3.0, 2.0, 0.0), taught=lambda: TAUGHT)


@pytest.mark.parametrize(
    ("limits", "arguments", "code"),
    [
        ("{places: {never: [kitchen]}}", {"room": "nest"}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"room": "The  NEST"}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"rounds": ["corner", "nest"]}, "policy_place"),
        ("{places: {never: [kitchen]}}", {"room": "corner"}, ""),
        ("{places: {never: [corner]}}", {"room": "corner"}, "policy_place"),
        ("{places: {only: [kitchen]}}", {"room": "nest"}, ""),
        ("{places: {only: [kitchen]}}", {"room": "corner"}, "policy_place"),
        ("{places: {only: [kitchen]}}", {"room": "gap"}, "policy_nowhere"),
        ("{places: {only: [living_room, nest]}}", {"room": "nest"}, "policy_place"),
        ("{distance_m: 3}", {"room": "nest"}, "policy_distance"),
        ("{goals: {x: {max: 5}}}", {"room": "nest"}, "policy_area"),
        ("{places: {never: [kitchen]}}", {"points": [{"x": 8.0, "y": 2.0}]}, "policy_place"),
        ("{goals: {x: {max: 5}}}", {"goal": {"x": 8.0, "y": 2.0}}, "policy_area"),
    ],
)
def test_a_taught_place_is_its_point_and_its_name_permits_nothing(limits, arguments, code):
    assert judged(limits, "go", TOLD, **arguments) == code


@pytest.mark.parametrize(
    ("limits", "distance", "towards_rad", "code"),
    [
        ("{places: {never: [kitchen]}}", 2.5, 0.0, "policy_place"),
        ("{places: {never: [kitchen]}}", 1.5, 0.0, ""),
        ("{places: {never: [kitchen]}}", 2.5, math.pi, ""),
        ("{places: {never: [kitchen]}}", -2.5, math.pi, "policy_place"),
        ("{places: {never: [kitchen]}}", 100.0, 0.0, "policy_place"),
        ("{places: {never: [living_room]}}", 0.5, 0.0, "policy_place"),
        ("{places: {never: [living_room]}}", 2.5, 0.0, ""),
        ("{places: {only: [living_room]}}", 0.5, 0.0, ""),
        ("{places: {only: [living_room]}}", 1.5, 0.0, "policy_nowhere"),
        ("{goals: {x: {max: 5}}}", 2.5, 0.0, "policy_area"),
        ("{goals: {x: {max: 5}}}", 1.5, 0.0, ""),
    ],
)
def test_a_straight_way_is_judged_by_what_it_crosses_and_where_it_ends(
    limits, distance, towards_rad, code
):
    arguments = {"distance": distance}
    verdict = policy(limits).judge(
        Way.VOICE, "walk", arguments, around=TOLD, now=MONDAY, towards_rad=towards_rad
    )
    assert verdict.reason.code == code


def test_who_does_not_know_where_it_is_walks_nowhere_where_places_are_limited():
    lost = PolicyContext(lambda: PLACES, rooms)
    assert judged("{places: {never: [kitchen]}}", "go", lost, distance=1.0) == "policy_lost"
    assert judged("{goals: {x: {max: 5}}}", "go", lost, distance=1.0) == "policy_lost"


@pytest.mark.parametrize("name", ["Navigate_To", "navigateto", "NAVIGATE_TO"])
def test_a_rule_is_for_a_skill_however_its_name_is_written(name):
    file = parse_policy(f"rules: {{voice: {{'*': allow, {name}: deny}}}}", "p.yaml")
    assert Policy(file).judge(Way.VOICE, "navigate_to", {}).rule is Rule.DENY
    assert Policy(file).judge(Way.VOICE, "navigate_xy", {}).rule is Rule.ALLOW
