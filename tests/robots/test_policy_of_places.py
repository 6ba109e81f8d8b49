"""Where a robot may not go it does not go, by whatever name, and its ways lead round it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

import pytest
from guards import HUNG_S
from held_time import HeldSkill

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.apps.agent.policy import build_guard
from edgevox.apps.robots import build_body, open_places
from edgevox.core.agent_events import AgentEvent, GoalChanged, GoalStatus, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput, Way
from edgevox.core.events import Responded
from edgevox.core.settings import check_settings

ROBOTS = ["robot-apartment", "robot-irsim"]
NEVER = "limits: {places: {never: [bedroom]}}"
IN_THE_BEDROOM = (2.5, 8.5)


class Talk:
    """A robot under a policy, as `edgevox-agent` builds it, in a world without real time."""

    def __init__(
        self,
        folder: Path,
        policy: str,
        robot: str = "robot-apartment",
        *,
        speed: float | None = None,
    ) -> None:
        self.file = folder / "policy.yaml"
        self.file.write_text(policy)
        settings = check_settings({"places": str(folder), "policy": str(self.file)})
        self.body: Any = build_body(robot, settings, speed)
        open_places(self.body, settings)
        self.said: list[str] = []
        self.codes: list[str] = []
        self.bus = bus = Bus()
        bus.subscribe(Responded, lambda event: self.said.append(event.text))
        bus.subscribe(AgentEvent, self._hear)
        self.guard = build_guard(settings, bus, self.body)
        agent = Agent(robot, "", SkillSet(self.body.skills))
        self.conversation = Conversation([agent], bus, halt=self.body.halt, guard=self.guard)

    def _hear(self, event: AgentEvent) -> None:
        if code := as_json(event).get("code"):
            self.codes.append(str(code))

    def __enter__(self) -> Self:
        self.body.start()
        self.conversation.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.conversation.close()
        self.body.close()

    def teach(self, name: str, x: float, y: float) -> None:
        """As the action `execute_skill` does."""
        goal = self.conversation.start_goal("remember_place", {"name": name, "x": x, "y": y})
        assert goal.wait(HUNG_S)
        assert goal.reason.text == ""

    def say(self, *sentences: str) -> str:
        for sentence in sentences:
            self.conversation.submit(TextInput(sentence))
            assert self.conversation.wait_idle(HUNG_S)
        return self.said[-1]

    def when_driving(self, to: str, then: Callable[[], object]) -> None:
        """Do something once, as the goal of this room begins, before anything else goes on."""
        waiting = [then]

        def hear(event: GoalChanged) -> None:
            there = event.arguments.get("room") == to
            if event.status is GoalStatus.RUNNING and there and waiting:
                waiting.pop()()

        self.bus.subscribe(GoalChanged, hear)

    @property
    def trod(self) -> set[str | None]:
        """The rooms that it was in."""
        return {self.body.place_at(*point) for point in self.body.trail()}


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_taught_place_is_judged_by_the_room_that_it_is_in(tmp_path, robot) -> None:
    with Talk(tmp_path, NEVER, robot) as one:
        one.teach("nest", *IN_THE_BEDROOM)

        assert "not permitted to go there" in one.say("go to the nest")
        one.say("patrol between the kitchen and the nest")
        with pytest.raises(SkillFailed) as denied:
            one.conversation.start_goal("navigate_to", {"room": "nest"}, way=Way.ACTION)

        assert denied.value.reason.code == "policy_place"
        assert "bedroom" not in one.trod


@pytest.mark.parametrize(
    ("limits", "code"),
    [("{distance_m: 2}", "policy_distance"), ("{goals: {y: {max: 5}}}", "policy_area")],
)
def test_a_taught_place_is_judged_by_its_distance_and_the_bounds(tmp_path, limits, code) -> None:
    with Talk(tmp_path, f"limits: {limits}") as one:
        one.teach("nest", *IN_THE_BEDROOM)
        one.say("go to the nest")

        assert one.codes[-1:] == [code]


def test_a_place_that_was_taught_before_the_policy_came_is_judged_by_it(tmp_path) -> None:
    with Talk(tmp_path, "rules: {}") as one:
        one.teach("nest", *IN_THE_BEDROOM)
        one.file.write_text(NEVER)
        one.say("go to the nest")

        assert one.codes[-1:] == ["policy_place"]


def test_a_goal_that_waited_is_judged_when_it_begins(tmp_path) -> None:
    with Talk(tmp_path, "rules: {}") as one:
        one.teach("nest", *IN_THE_BEDROOM)
        one.when_driving("kitchen", lambda: one.file.write_text(NEVER))
        one.say("go to the kitchen and then go to the nest")

        assert one.codes[-1:] == ["policy_place"]
        assert one.said[-1].startswith("I could not do that") or "not permitted" in one.said[-1]
        assert one.trod == {"living_room", "kitchen"}


def test_a_step_of_a_patrol_is_judged_when_it_begins(tmp_path) -> None:
    with Talk(tmp_path, "rules: {}") as one:
        one.teach("nest", *IN_THE_BEDROOM)
        one.when_driving("kitchen", lambda: one.file.write_text(NEVER))
        one.say("patrol between the kitchen and the nest")

        assert "policy_place" in one.codes
        assert one.trod == {"living_room", "kitchen"}


def test_a_place_that_is_taught_anew_elsewhere_is_judged_by_where_it_is_now(tmp_path) -> None:
    with Talk(tmp_path, NEVER) as one:
        one.teach("nest", 7.0, 1.2)

        def move() -> None:
            one.body.place_memory.forget("nest")
            one.teach("nest", *IN_THE_BEDROOM)

        one.when_driving("kitchen", move)
        one.say("go to the kitchen and then go to the nest")

        assert one.codes[-1:] == ["policy_place"]
        assert "bedroom" not in one.trod


def test_a_drive_that_another_policy_forbids_ends_with_its_reason(tmp_path) -> None:
    with Talk(tmp_path, "rules: {}", speed=0.0) as one:
        goal = one.conversation.start_goal("navigate_to", {"room": "bedroom"})
        one.file.write_text(NEVER)

        assert goal.wait(HUNG_S)
        assert (goal.status, goal.reason.code) == (GoalStatus.FAILED, "policy_place")
        assert not one.body.in_motion


@pytest.mark.parametrize(
    "robot", ["robot-apartment", pytest.param("robot-irsim", marks=pytest.mark.long)]
)
@pytest.mark.parametrize("room", ["bedroom", "living_room", "office", "kitchen"])
def test_its_way_leads_round_a_forbidden_room(tmp_path, robot, room) -> None:
    with Talk(tmp_path, f"limits: {{places: {{never: [{room}]}}}}", robot) as one:
        order = [other for other in one.body.places if other != room]
        one.say(f"go to the {order[0].replace('_', ' ')}")  # it may stand in the forbidden one
        began = len(one.body.trail())
        for other in (*order, *reversed(order)):
            one.say(f"go to the {other.replace('_', ' ')}")

        assert {one.body.place_at(*point) for point in one.body.trail()[began:]} == {*order}
        assert one.codes == []


def test_where_every_way_leads_through_a_forbidden_room_the_drive_is_refused_with_it(
    tmp_path,
) -> None:
    with Talk(tmp_path, "limits: {places: {never: [bedroom, kitchen]}}") as one:
        said = one.say("go to the office")

        assert one.codes[-1:] == ["policy_way"]
        assert "kitchen" in said or "bedroom" in said
        assert one.trod == {"living_room"}


def test_a_robot_in_a_forbidden_room_may_leave_it_and_not_come_back(tmp_path) -> None:
    with Talk(tmp_path, "rules: {}") as one:
        one.say("go to the bedroom")
        one.file.write_text(NEVER)
        one.say("go to the kitchen")
        one.say("go to x 2.5, y 8.5")

        assert one.body.place_at(one.body.pose().x_m, one.body.pose().y_m) == "kitchen"
        assert one.codes[-1:] == ["policy_place"]


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
    with Talk(tmp_path, f"limits: {{places: {{never: [{name}]}}}}") as one:
        one.say("go to the bedroom")

        assert one.codes[-1:] == ["policy_place"]
        assert one.trod == {"living_room"}


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
    with Talk(tmp_path, "rules: {}") as one:
        with pytest.raises(SkillFailed) as refused:
            one.conversation.start_goal("remember_place", {"name": name, "x": x, "y": y})

        assert refused.value.reason.code in ("place_of_the_map", "place_name_reserved")
        one.say("go to the kitchen")
        assert "bedroom" not in one.trod
