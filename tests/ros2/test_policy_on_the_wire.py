"""Each way in on the wire is under the policy, one by one; a stop is under none."""

import json
import subprocess
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import phrases
import pytest
from action_rig import Client
from agent_process import READY, Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Twist
from interop_rig import Stream, hear, seconds, tell, twist
from nav_msgs.msg import Odometry
from peer import SENSOR, Peer, wait_until
from ports import free_port
from rclpy.qos import qos_profile_sensor_data
from scraper import scrape_until as wait_for_metrics
from watched_robot import LET_GO_S

DENIED = phrases.refused("policy_denied")
NOTHING_BUT_A_SENTENCE = "rules: {'*': deny, text_input: {navigate_to: allow}}"
CMD_VEL, GOAL_POSE = "/edgevox/cmd_vel", "/edgevox/goal_pose"


class Robot:
    """An agent under a policy that a test writes, and everything that a peer sees of it."""

    def __init__(self, process: Agent, peer: Peer, file: Path, port: int) -> None:
        self.process, self.peer, self._file, self.port = process, peer, file, port
        self.events = peer.listen("agent_event")
        self.answers = peer.listen("response")
        self.odom = hear(peer, Odometry, "/edgevox/odom", qos_profile_sensor_data)
        self.health = hear(peer, DiagnosticArray, "/diagnostics")

    def under(self, policy: str) -> None:
        """Put another file in its place, and wait until the robot has read it."""
        other = self._file.with_suffix(".new")
        other.write_text(f"about: number {next(NUMBERS)}\n{policy}", encoding="utf-8")
        other.replace(self._file)
        about = other_about(self._file)
        self.status(lambda one: one.message.endswith(about) or "cannot be used" in one.message)

    def status(self, wanted: Callable[[DiagnosticStatus], bool]) -> DiagnosticStatus:
        """What `policy` says of itself on /diagnostics from now on, once it is as wanted."""
        found: list[DiagnosticStatus] = []

        def look(array: DiagnosticArray) -> bool:
            ours = [one for one in array.status if one.name == "/edgevox/edgevox: policy"]
            found[:] = [one for one in ours if wanted(one)]
            return bool(found)

        self.health.wait_for(look, since=len(self.health.messages))
        return found[0]

    def from_now(self) -> "Since":
        return Since(self, len(self.events.messages), len(self.answers.messages))


class Since:
    """What was heard since a moment."""

    def __init__(self, robot: Robot, events: int, answers: int) -> None:
        self._robot, self._events, self._answers = robot, events, answers

    def rejected(self, way: str) -> dict[str, Any]:
        """The event of what was refused by this way."""
        return self.event(lambda one: one.get("way") == way and one["status"] == "rejected")

    def event(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        heard = self._robot.events.wait_for(lambda m: wanted(json.loads(m)), since=self._events)
        return dict(json.loads(heard))

    def answer(self) -> str:
        return str(self._robot.answers.wait_for(lambda _: True, since=self._answers))

    def drives(self) -> None:
        """A goal of a drive runs."""
        self.event(
            lambda one: one.get("skill", "").startswith("nav") and one.get("status") == "running"
        )

    def none_ran(self) -> bool:
        told = [json.loads(one) for one in self._robot.events.messages[self._events :]]
        return not any(one.get("status") == "running" for one in told)


def speed(message: Odometry) -> float:
    return abs(message.twist.twist.linear.x)


NUMBERS = iter(range(1_000_000))


def other_about(file: Path) -> str:
    return file.read_text(encoding="utf-8").partition("\n")[0].removeprefix("about: ")


@pytest.fixture(scope="module")
def _process(
    domain: int, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Agent, Path, int]]:
    file = tmp_path_factory.mktemp("policy") / "policy.yaml"
    file.write_text("rules: {}", encoding="utf-8")
    port = free_port()
    arguments = ("--text-mode", "--simple-ui", "--ros2", "--llm", "none", "--policy", str(file))
    one = Agent(
        "robot-apartment",
        *arguments,
        "--metrics-port",
        str(port),
        domain=domain,
        stdin=subprocess.PIPE,
    )
    try:
        one.wait_for_line(READY)
        yield one, file, port
    finally:
        one.terminate()
        one.process.stdin.close()


@pytest.fixture(scope="module")
def _robot(_process: tuple[Agent, Path, int]) -> Iterator[Robot]:
    process, file, port = _process
    with closing(Peer(process.domain)) as peer:
        yield Robot(process, peer, file, port)


@pytest.fixture
def robot(_robot: Robot) -> Iterator[Robot]:
    """Each test puts it under a policy of its own; a stop is under none."""
    yield _robot
    _robot.peer.send("interrupt", "")
    _robot.odom.wait_for(lambda m: speed(m) < 0.01, since=len(_robot.odom.messages))


def goal_pose(x_m: float, y_m: float) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = "map"
    message.pose.position.x, message.pose.position.y = x_m, y_m
    return message


def ask_by_text_input(robot: Robot) -> None:
    robot.peer.send("text_input", "go to the kitchen")


def ask_by_typing(robot: Robot) -> None:
    print("go to the kitchen", file=robot.process.process.stdin, flush=True)


def ask_by_the_action(robot: Robot) -> None:
    Client(robot.peer).send("navigate_to", room="kitchen")


def ask_by_goal_pose(robot: Robot) -> None:
    tell(robot.peer, PoseStamped, GOAL_POSE)(goal_pose(7.0, 2.0))


ASK = {
    "text_input": ask_by_text_input,
    "typed": ask_by_typing,
    "action": ask_by_the_action,
    "goal_pose": ask_by_goal_pose,
}


@pytest.mark.parametrize("way", ASK)
def test_a_way_that_is_denied_moves_nothing_and_says_so_with_its_code(robot, way):
    robot.under(f"rules: {{{way}: deny}}")
    since = robot.from_now()
    ASK[way](robot)
    rejected = since.rejected(way)
    assert rejected["code"] == "policy_denied"
    assert rejected["values"]["way"] == way
    if way in {"text_input", "typed"}:
        assert since.answer() == DENIED
    assert since.none_ran()


@pytest.mark.parametrize("way", ASK)
def test_a_way_that_is_allowed_moves_though_all_others_are_denied(robot, way):
    robot.under(f"rules: {{'*': deny, {way}: {{'*': allow}}}}")
    since = robot.from_now()
    ASK[way](robot)
    since.drives()


@pytest.mark.parametrize("way", ASK)
def test_what_needs_a_yes_does_not_move_unasked(robot, way):
    robot.under("rules: {'*': confirm}")
    since = robot.from_now()
    ASK[way](robot)
    if way in {"text_input", "typed"}:
        # A question that was still open is replaced, which is told first.
        asked = since.event(
            lambda one: (one["kind"], one.get("status")) == ("confirmation", "asked")
        )
        assert asked["calls"][0]["skill"][:3] == "nav"
    else:
        assert since.rejected(way)["code"] == "needs_a_person"
    assert since.none_ran()


def test_a_goal_that_a_client_sends_is_rejected_and_the_next_one_taken(robot):
    robot.under("limits: {places: {never: [kitchen]}}")
    client = Client(robot.peer)
    assert not client.send("navigate_to", room="kitchen").accepted
    assert client.send("navigate_to", room="office").accepted


@pytest.mark.parametrize(
    ("limits", "x_m", "code"),
    [
        ("{places: {never: [kitchen]}}", 7.0, "policy_place"),
        ("{goals: {x: {max: 6}}}", 7.0, "policy_area"),
        ("{distance_m: 1}", 7.0, "policy_distance"),
    ],
)
def test_a_goal_pose_beyond_a_limit_is_refused_with_its_code(robot, limits, x_m, code):
    robot.under(f"limits: {limits}")
    since = robot.from_now()
    tell(robot.peer, PoseStamped, GOAL_POSE)(goal_pose(x_m, 2.0))
    assert since.rejected("goal_pose")["code"] == code


@contextmanager
def streaming(robot: Robot, linear: float, angular: float = 0.0) -> Iterator[None]:
    """Somebody steers, and then lets go for so long that the next one counts, also after a stop."""
    stream = Stream(tell(robot.peer, Twist, CMD_VEL, SENSOR), twist(linear, angular))
    try:
        yield
    finally:
        stream.end()
        over_s = seconds(robot.odom.messages[-1].header.stamp) + LET_GO_S
        robot.odom.wait_for(
            lambda m: seconds(m.header.stamp) > over_s, since=len(robot.odom.messages)
        )


@pytest.mark.parametrize("word", ["deny", "confirm"])
def test_velocities_that_are_denied_turn_no_wheel_and_are_told_once_a_second(robot, word):
    robot.under(f"rules: {{cmd_vel: {word}}}")
    since, before = robot.from_now(), len(robot.odom.messages)
    wanted = "policy_denied" if word == "deny" else "needs_a_person"
    with streaming(robot, 0.4):
        assert since.rejected("cmd_vel")["code"] == wanted
        robot.odom.wait_for_more(20)
    assert max(map(speed, robot.odom.messages[before:])) < 0.01


def test_velocities_are_slowed_to_what_is_permitted(robot):
    robot.under("rules: {'*': deny, cmd_vel: allow}\nlimits: {speed: {linear_m_s: 0.1}}")
    before = len(robot.odom.messages)
    with streaming(robot, 0.4, 0.8):  # away from a wall
        robot.odom.wait_for(lambda m: speed(m) > 0.09, since=before)
        robot.odom.wait_for_more(20)
    assert max(map(speed, robot.odom.messages[before:])) < 0.11


def drive_far(robot: Robot) -> Since:
    """Set it in motion by a sentence, which nothing but that may be; what is heard from then on."""
    since = robot.from_now()
    robot.peer.send("text_input", "go to the bedroom")
    since.drives()
    return since


def test_a_velocity_of_zero_ends_a_drive_though_velocities_are_denied(robot):
    robot.under(NOTHING_BUT_A_SENTENCE)
    since = drive_far(robot)
    with streaming(robot, 0.0):  # best effort: one may be lost
        since.event(lambda one: one["kind"] == "skill_cancelled")


def test_a_command_is_refused_by_its_name(robot):
    robot.under("rules: {command: {mute: deny, '*': allow}}")
    since = robot.from_now()
    robot.peer.send("command", "mute")
    assert since.rejected("command")["skill"] == "mute"
    info = robot.peer.listen("info")
    robot.peer.send("command", "list_voices")
    info.wait_for(lambda m: "list_voices" in m)


@pytest.mark.parametrize("stop", ["text_input", "interrupt", "command", "action"])
def test_a_stop_is_taken_whatever_the_policy(robot, stop):
    robot.under(NOTHING_BUT_A_SENTENCE)
    client = Client(robot.peer)
    since = drive_far(robot)
    if stop == "action":
        assert client.send("stop").accepted
    else:
        robot.peer.send(stop, "reset" if stop == "command" else "stop")
    since.event(lambda one: one["kind"] == "skill_cancelled")
    robot.odom.wait_for(lambda m: speed(m) < 0.01, since=len(robot.odom.messages))


def test_a_broken_file_leaves_the_old_policy_in_force_and_is_a_warning_until_it_is_mended(robot):
    robot.under("rules: {text_input: deny}")
    robot.under("rules: {text_input: perhaps}")
    status = robot.status(lambda one: one.level == DiagnosticStatus.WARN)
    assert "rules.text_input.*: got 'perhaps'" in status.message
    since = robot.from_now()
    ask_by_text_input(robot)
    assert since.answer() == DENIED
    wait_for_metrics(robot.port, lambda said: said["edgevox_policy_broken",] == 1)
    robot.under("rules: {text_input: allow}")
    robot.status(lambda one: one.level == DiagnosticStatus.OK)
    since = robot.from_now()
    ask_by_text_input(robot)
    since.drives()


def test_a_refusal_is_counted_on_metrics_and_seen_on_diagnostics(robot):
    robot.under("rules: {text_input: {navigate_to: deny}, command: deny}")
    since = robot.from_now()
    ask_by_text_input(robot)
    since.rejected("text_input")
    robot.peer.send("command", "mute")
    since.rejected("command")
    told = {one.key: one.value for one in robot.status(lambda _: True).values}
    assert int(told["refused"]) >= 2
    assert told["last_refused"] == "command mute: policy_denied"
    said = wait_for_metrics(
        robot.port,
        lambda s: s.get(("edgevox_policy_refusals_total", "policy_denied", "text_input"), 0),
    )
    assert said["edgevox_refused_messages_total", "forbidden", "command"] >= 1


@pytest.fixture
def german(robot: Robot) -> Iterator[Robot]:
    robot.under("rules: {}")
    speak(robot, "de")
    yield robot
    robot.under("rules: {}")
    speak(robot, "en")


def speak(robot: Robot, code: str) -> None:
    """Switch the language, and wait until it counts: topics have no order among them."""
    info = robot.peer.listen("info")
    robot.peer.send("set_language", code)

    def switched() -> bool:
        known = len(info.messages)
        robot.peer.send("command", "list_languages")
        return json.loads(info.wait_for(lambda _: True, since=known))["current"] == code

    wait_until(switched, code)


def test_the_reason_is_said_in_the_language_that_is_spoken(german):
    german.under("rules: {text_input: deny}")
    since = german.from_now()
    german.peer.send("text_input", "fahr in die Küche")
    assert since.answer() == phrases.refused("policy_denied", language="de")
