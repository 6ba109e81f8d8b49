"""What the console is shown of the robot of the apartment, and how it is steered from there.

Time passes in its world only as far as the test says.
"""

import io
import json
import threading
from contextlib import ExitStack

import numpy as np
import phrases
import pytest
from guards import HUNG_S
from PIL import Image

from edgevox.agent.policy import Denied
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.console.build_context import build_context
from edgevox.apps.console.shown_robot import ShownRobot
from edgevox.core.agent_events import GoalChanged, GoalRejected
from edgevox.core.commands import TextInput, Way
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded
from edgevox.core.motion.interlock import Interlock
from edgevox.core.settings import load_settings
from edgevox.core.status import Level
from edgevox.core.transforms import Pose2D
from edgevox.robots.flat.apartment import ApartmentRobot

STEP_S = 0.1
POLICY = """
rules: {console_operator: {navigate_xy: deny, remember_place: deny}}
limits:
  places: {never: [bedroom]}
  speed: {linear_m_s: 0.2}
"""


class Console:
    """The console's context of a whole agent whose robot's time is held."""

    def __init__(self, stack, **settings):
        text = {"text_mode": True, "llm": "none", **settings}
        self.body = ApartmentRobot(speed=0.0)
        self.parts = build_parts(stack, load_settings(text, None), self.body)
        self.said, self.moved, self.news = [], threading.Event(), threading.Condition()
        self.parts.bus.subscribe(Responded, self._hear)
        self.parts.bus.subscribe(GoalChanged, lambda goal: goal.feedback and self.moved.set())
        self.context = build_context(self.parts)
        self.robot = self.context.robot
        start_parts(stack, self.parts)

    def until_said(self, text):
        with self.news:
            assert self.news.wait_for(lambda: any(text in one for one in self.said), HUNG_S)

    def described(self, language="en"):
        told = self.context.describe(language)
        return {one["name"]: one for one in told["skills"]}

    def _hear(self, event):
        with self.news:
            self.said.append(event.text)
            self.news.notify_all()


@pytest.fixture
def console():
    with ExitStack() as stack:
        yield Console(stack)


@pytest.fixture
def limited(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text(POLICY)
    with ExitStack() as stack:
        yield Console(stack, policy=str(file))


def test_all_that_a_page_is_told_is_json(console):
    for told in (
        console.robot.scene(),
        console.robot.live(),
        console.context.describe("de"),
        console.context.status(),
    ):
        json.dumps(told, allow_nan=False)


def test_the_map_has_walls_rooms_and_furniture_and_stays_the_same_while_the_robot_drives(console):
    scene = console.robot.scene()
    assert {room["name"] for room in scene["rooms"]} == set(console.body.places)
    assert scene["walls"]
    assert scene["radius"] == console.body.world.robot.radius_m
    x0, y0, x1, y1 = scene["bounds"]
    assert x0 <= 0.0 < x1
    assert y0 <= 0.0 < y1
    console.robot.drive(0.2, 0.0)
    console.body.advance(STEP_S)
    assert console.robot.scene() == scene


def test_a_place_that_it_was_told_to_remember_is_another_scene(console):
    before = console.robot.scene()
    console.body.place_memory.remember("charger", Pose2D(1.0, 2.0, 0.0), "map")
    after = console.robot.scene()
    assert after["places"] == [{"name": "charger", "label": "charger", "x": 1.0, "y": 2.0}]
    assert after["version"] != before["version"]


def test_the_lidar_is_shown_where_its_beams_end_on_the_map(console):
    shown = np.array(console.robot.live()["lidar"]).reshape(-1, 2)
    scan, pose = console.body.scan(), console.body.pose()
    far = np.hypot(shown[:, 0] - pose.x_m, shown[:, 1] - pose.y_m)
    hits = scan.ranges_m[np.isfinite(scan.ranges_m)]
    assert far == pytest.approx(hits, abs=0.02)
    x0, y0, x1, y1 = console.robot.scene()["bounds"]
    assert (shown >= (x0 - 0.02, y0 - 0.02)).all()
    assert (shown <= (x1 + 0.02, y1 + 0.02)).all()


def test_a_point_of_the_map_is_driven_to_and_its_path_and_goal_are_shown(console):
    console.context.submit(console.context.go_to(3.0, 4.0))
    assert console.moved.wait(HUNG_S)
    live = console.robot.live()
    assert (live["goal"]["x"], live["goal"]["y"]) == (3.0, 4.0)
    assert live["moving"]
    assert live["path"][-1] == pytest.approx([3.0, 4.0], abs=0.1)
    assert live["battery"]["level"] == 1.0


def test_a_point_of_the_map_is_named_and_the_name_is_understood_and_shown(console):
    console.context.submit(console.context.name_place("charger", 3.0, 4.0))
    console.until_said(phrases.done("remember_place", name="charger"))
    (place,) = console.robot.scene()["places"]
    assert (place["name"], place["x"], place["y"]) == ("charger", 3.0, 4.0)
    console.context.submit(TextInput("go to the charger", Way.CONSOLE_OPERATOR))
    assert console.moved.wait(HUNG_S)
    live = console.robot.live()
    assert (live["goal"]["x"], live["goal"]["y"]) == (3.0, 4.0)


def test_the_log_of_a_turn_is_told_without_what_was_said(console, caplog):
    caplog.set_level("INFO", logger="edgevox")
    lines, ended = [], threading.Event()

    def note(line):
        lines.append(line)
        if line["event"] == "turn_ended":
            ended.set()

    forget = console.context.follow_log(note)
    console.context.submit(TextInput("where are you", Way.CONSOLE_OPERATOR))
    assert ended.wait(HUNG_S)
    forget()
    told = {one["event"]: one["text"] for one in lines}
    assert told["turn_began"] == "text=<13 characters>"
    assert told["skill_called"] == "path=template skill=get_pose arguments={}"


def test_the_policy_forbids_to_name_a_point(limited):
    rejected = threading.Event()
    limited.parts.bus.subscribe(GoalRejected, lambda one: rejected.set())
    limited.context.submit(limited.context.name_place("charger", 3.0, 4.0))
    assert rejected.wait(HUNG_S)
    assert limited.robot.scene()["places"] == []


def test_the_stick_steers_and_one_zero_ends_it(console):
    console.robot.drive(0.3, 0.0)
    console.body.advance(0.4)
    assert console.robot.live()["velocity"]["linear"] == pytest.approx(0.3, abs=0.01)
    console.robot.halt()
    console.body.advance(0.4)
    assert console.robot.live()["velocity"]["linear"] == pytest.approx(0.0, abs=1e-6)


def test_a_stopped_robot_is_not_steered_and_says_why(console):
    console.robot.drive(0.3, 0.0)
    console.body.advance(0.2)
    console.context.safety.stop("a phone")
    with pytest.raises(SkillFailed) as failed:
        console.robot.drive(0.3, 0.0)
    assert failed.value.reason == because("software_stop")
    console.body.advance(0.1)
    assert console.robot.live()["velocity"]["linear"] == pytest.approx(0.0, abs=1e-6)
    console.robot.halt()
    assert console.context.safety.state.by == "a phone"


def test_the_stick_heeds_the_speed_that_the_policy_permits(limited):
    told = limited.robot.capabilities["drive"]
    assert told == {"linear": 0.2, "angular": limited.body.max_angular_rad_s}
    limited.robot.drive(0.8, 0.0)
    limited.body.advance(0.4)
    assert limited.robot.live()["velocity"]["linear"] == pytest.approx(0.2, abs=0.01)


def test_the_policy_may_forbid_the_stick_to_the_console_only(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {console_operator: {cmd_vel: deny}}\n")
    with ExitStack() as stack:
        console = Console(stack, policy=str(file))
        with pytest.raises(Denied):
            console.robot.drive(0.3, 0.0)
        assert console.parts.guard.velocity(0.3, 0.0) == (0.3, 0.0)


def test_forms_hold_the_policys_limits_and_say_what_is_forbidden(limited):
    skills = limited.described()
    assert "bedroom" not in skills["navigate_to"]["schema"]["properties"]["room"]["enum"]
    assert not skills["navigate_xy"]["allowed"]
    assert skills["stop"]["allowed"]
    assert skills["navigate_to"]["moves"]
    assert not skills["get_pose"]["moves"]


def test_forms_are_told_in_the_language_of_the_page(console):
    told = console.context.describe("de")
    assert told["words"]["kitchen"] == "Küche"
    assert told["arguments"]["room"] == "Zimmer"
    english, german = (console.described(one)["navigate_to"] for one in ("en", "de"))
    assert (german["label"], german["language"]) == ("in ein Zimmer fahren", "de")
    assert not german["description"]
    assert english["language"] == "en"
    assert english["description"]


@pytest.mark.parametrize("yes", [True, False])
def test_a_button_answers_what_it_asked(yes):
    with ExitStack() as stack:
        console = Console(stack, confirm="always")
        console.context.submit(TextInput("go to the kitchen", Way.CONSOLE_OPERATOR))
        console.until_said("Shall I")
        known = len(console.said)
        console.context.answer(yes, Way.CONSOLE_OPERATOR)
        with console.news:
            assert console.news.wait_for(lambda: len(console.said) > known, HUNG_S)
        assert (phrases.begins("navigate_to", room="kitchen") in console.said) is yes


def test_status_has_health_and_every_component_with_the_stop(console):
    console.context.safety.stop("a phone")
    status = console.context.status()
    found = {one["name"]: one["level"] for one in status["diagnostics"]}
    assert found["interlock"] == Level.WARN
    assert status["health"]["live"]
    assert set(found) == {one.name for one in console.parts.components.statuses()}


def test_a_2d_robot_is_shown_as_a_map_and_not_as_a_picture(console):
    assert console.robot.picture() is None
    offered = console.context.describe("en")["capabilities"]
    assert offered["drive"] == {
        "linear": console.body.max_linear_m_s,
        "angular": console.body.max_angular_rad_s,
    }
    assert (offered["picture"], offered["map"], offered["goto"]) == (False, True, True)


def test_a_camera_that_others_run_is_shown_while_its_pictures_come_and_can_be(console):
    class Seen:
        name, skills, picture_now = "seen", (), None

        def newest_picture(self):
            if isinstance(self.picture_now, Exception):
                raise self.picture_now
            return self.picture_now

    body = Seen()
    shown = ShownRobot(body, Interlock(), console.parts.guard, str)
    assert shown.capabilities["picture"]
    assert shown.picture() is None
    body.picture_now = InvalidValue("encoding", "16UC1", "rgb8")
    assert shown.picture() is None
    body.picture_now = np.zeros((1080, 1920, 3), np.uint8)
    assert Image.open(io.BytesIO(shown.picture())).size == (960, 540)


def test_a_body_that_only_shows_itself_gives_a_jpeg_and_is_not_steered(console):
    class Painted:
        name, skills = "painted", ()

        def picture(self):
            return np.zeros((12, 16, 3), np.uint8)

        def state(self):
            return {"time": 0.0}

    shown = ShownRobot(Painted(), Interlock(), console.parts.guard, str)
    assert Image.open(io.BytesIO(shown.picture())).size == (16, 12)
    assert shown.live() == {"time": 0.0, "goal": None, "moving": False}
    assert shown.capabilities["drive"] is False
    assert len(shown.scene()["bounds"]) == 4
    shown.halt()


def test_why_something_is_not_done_is_told_in_the_language_of_each_page(console):
    explain = console.context.explain
    known = because("place_known", place="Zanzibar", x="1.0", y="2.0")
    assert explain(known, "en") != explain(known, "de")
    assert "Zanzibar" in explain(known, "de")
    assert explain(SkillFailed(known), "de") == explain(known, "de")
    assert explain(known, "xx") == explain(known, "en")  # the robot's own
    assert explain(SkillFailed("the door is locked"), "de") == "the door is locked"
    assert explain(InvalidValue("x", "far", "a number"), "de") == ""
