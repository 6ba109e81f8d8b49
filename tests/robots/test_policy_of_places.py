"""Where a robot may not go it does not go, by whatever name, and its ways lead round it."""

from collections.abc import Callable
from typing import Any

import pytest
from guards import HUNG_S
from held_time import HeldSkill
from spoken_robot import SpokenRobot, trod

from edgevox.agent.skills import SkillFailed
from edgevox.apps.robots import build_body
from edgevox.core.agent_events import GoalChanged, GoalStatus
from edgevox.core.commands import Way
from edgevox.core.settings import check_settings

ROBOTS = ["robot-apartment", "robot-irsim"]
NEVER = "limits: {places: {never: [bedroom]}}"
IN_THE_BEDROOM = (2.5, 8.5)


def teach(robot: SpokenRobot, x_m: float, y_m: float) -> None:
    """A place that is called the nest, as the action `execute_skill` does."""
    place = {"name": "nest", "x": x_m, "y": y_m}
    goal = robot.conversation.start_goal("remember_place", place)
    assert goal.wait(HUNG_S)
    assert goal.reason.text == ""


def when_driving(robot: SpokenRobot, to: str, then: Callable[[], object]) -> None:
    """Do something once, as the goal of this room begins, before anything else goes on."""
    waiting = [then]

    def hear(event: GoalChanged) -> None:
        there = event.arguments.get("room") == to
        if event.status is GoalStatus.RUNNING and there and waiting:
            waiting.pop()()

    robot.bus.subscribe(GoalChanged, hear)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_taught_place_is_judged_by_the_room_that_it_is_in(tmp_path, robot) -> None:
    with SpokenRobot(tmp_path, robot, NEVER) as one:
        teach(one, *IN_THE_BEDROOM)

        assert "not permitted to go there" in one.say("go to the nest")
        one.say("patrol between the kitchen and the nest")
        with pytest.raises(SkillFailed) as denied:
            one.conversation.start_goal("navigate_to", {"room": "nest"}, way=Way.ACTION)

        assert denied.value.reason.code == "policy_place"
        assert "bedroom" not in trod(one)


@pytest.mark.parametrize(
    ("limits", "code"),
    [("{distance_m: 2}", "policy_distance"), ("{goals: {y: {max: 5}}}", "policy_area")],
)
def test_a_taught_place_is_judged_by_its_distance_and_the_bounds(tmp_path, limits, code) -> None:
    with SpokenRobot(tmp_path, policy=f"limits: {limits}") as one:
        teach(one, *IN_THE_BEDROOM)
        one.say("go to the nest")

        assert one.told("code")[-1:] == [code]


def test_a_place_that_was_taught_before_the_policy_came_is_judged_by_it(tmp_path) -> None:
    with SpokenRobot(tmp_path) as one:
        teach(one, *IN_THE_BEDROOM)
        one.under(NEVER)
        one.say("go to the nest")

        assert one.told("code")[-1:] == ["policy_place"]


def test_a_goal_that_waited_is_judged_when_it_begins(tmp_path) -> None:
    with SpokenRobot(tmp_path) as one:
        teach(one, *IN_THE_BEDROOM)
        when_driving(one, "kitchen", lambda: one.under(NEVER))
        one.say("go to the kitchen and then go to the nest")

        assert one.told("code")[-1:] == ["policy_place"]
        assert one.said[-1].startswith("I could not do that") or "not permitted" in one.said[-1]
        assert trod(one) == {"living_room", "kitchen"}


def test_a_step_of_a_patrol_is_judged_when_it_begins(tmp_path) -> None:
    with SpokenRobot(tmp_path) as one:
        teach(one, *IN_THE_BEDROOM)
        when_driving(one, "kitchen", lambda: one.under(NEVER))
        one.say("patrol between the kitchen and the nest")

        assert "policy_place" in one.told("code")
        assert trod(one) == {"living_room", "kitchen"}


def test_a_place_that_is_taught_anew_elsewhere_is_judged_by_where_it_is_now(tmp_path) -> None:
    with SpokenRobot(tmp_path, policy=NEVER) as one:
        teach(one, 7.0, 1.2)

        def move() -> None:
            one.body.place_memory.forget("nest")
            teach(one, *IN_THE_BEDROOM)

        when_driving(one, "kitchen", move)
        one.say("go to the kitchen and then go to the nest")

        assert one.told("code")[-1:] == ["policy_place"]
        assert "bedroom" not in trod(one)


def test_a_drive_that_another_policy_forbids_ends_with_its_reason(tmp_path) -> None:
    with SpokenRobot(tmp_path, speed=0.0) as one:
        goal = one.conversation.start_goal("navigate_to", {"room": "bedroom"})
        one.under(NEVER)

        assert goal.wait(HUNG_S)
        assert (goal.status, goal.reason.code) == (GoalStatus.FAILED, "policy_place")
        assert not one.body.in_motion


@pytest.mark.parametrize(
    "robot", ["robot-apartment", pytest.param("robot-irsim", marks=pytest.mark.long)]
)
@pytest.mark.parametrize("room", ["bedroom", "living_room", "office", "kitchen"])
def test_its_way_leads_round_a_forbidden_room(tmp_path, robot, room) -> None:
    with SpokenRobot(tmp_path, robot, f"limits: {{places: {{never: [{room}]}}}}") as one:
        order = [other for other in one.body.places if other != room]
        one.say(f"go to the {order[0].replace('_', ' ')}")  # it may stand in the forbidden one
        began = len(one.body.trail())
        for other in (*order, *reversed(order)):
            one.say(f"go to the {other.replace('_', ' ')}")

        assert {one.body.place_at(*point) for point in one.body.trail()[began:]} == {*order}
        assert one.told("code") == []


def test_where_every_way_leads_through_a_forbidden_room_the_drive_is_refused_with_it(
    tmp_path,
) -> None:
    with SpokenRobot(tmp_path, policy="limits: {places: {never: [bedroom, kitchen]}}") as one:
        said = one.say("go to the office")

        assert one.told("code")[-1:] == ["policy_way"]
        assert "kitchen" in said or "bedroom" in said
        assert trod(one) == {"living_room"}


def test_a_robot_in_a_forbidden_room_may_leave_it_and_not_come_back(tmp_path) -> None:
    with SpokenRobot(tmp_path) as one:
        one.say("go to the bedroom")
        one.under(NEVER)
        one.say("go to the kitchen")
        one.say("go to x 2.5, y 8.5")

        assert one.body.place_at(one.body.pose().x_m, one.body.pose().y_m) == "kitchen"
        assert one.told("code")[-1:] == ["policy_place"]


def test_a_room_that_becomes_forbidden_while_it_drives_is_driven_round_from_then_on() -> None:
    settings = check_settings({})
    body: Any = build_body("robot-apartment", settings, 0.0)
    forbidden: list[str] = []
    body.avoid_places(lambda: tuple(forbidden))
    body.start()
    try:
        drive = HeldSkill(body, body.drive_to, 6.6, 7.2)
        forbidden.append("bedroom")
        drive.report()
        drive.report()
        assert drive.end() is None
        assert "bedroom" not in {body.place_at(*point) for point in body.trail()}
    finally:
        body.close()


@pytest.mark.parametrize("name", ["Bed_Room", "the bedrooms", "Schlafzimmer", "BÉDROOM"])
def test_a_policy_names_a_room_as_people_do(tmp_path, name) -> None:
    with SpokenRobot(tmp_path, policy=f"limits: {{places: {{never: [{name}]}}}}") as one:
        one.say("go to the bedroom")

        assert one.told("code")[-1:] == ["policy_place"]
        assert trod(one) == {"living_room"}


@pytest.mark.parametrize(
    "name",
    [
        "the kitchen", "a kitchen", "my kitchen", "kitchens", "Kitchen", "kítchen",
        "kit chen", "kit_chen", "kitchen's", "our kitchens", "die Küche", "kitchen now",
        "kitchen and office", "to the kitchen", "go to the kitchen", "home", "go back",
        "go home", "where are you", "geh in die Küche", "去厨房",
        "kichen", "back", "my own kitchen", "kitchen here", "mutfağım", "dapurku",
    ],
)  # fmt: skip
def test_no_taught_name_is_read_as_a_room_of_the_map_or_as_an_order(tmp_path, name) -> None:
    x, y = IN_THE_BEDROOM
    with SpokenRobot(tmp_path) as one:
        with pytest.raises(SkillFailed) as refused:
            one.conversation.start_goal("remember_place", {"name": name, "x": x, "y": y})

        assert refused.value.reason.code in ("place_of_the_map", "place_name_reserved")
        one.say("go to the kitchen")
        assert "bedroom" not in trod(one)
