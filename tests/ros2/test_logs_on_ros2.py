"""Logs and ROS 2: one stream, /rosout, levels by services and by arguments."""

import json

import pytest
from peer import STATE
from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from waiting import wait_until

ROSOUT = QoSProfile(
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
JSON = ("--log-format", "json")
SECRET = "xyzzy plugh"  # noqa: S105 - said aloud
DEBUG, WARN = 10, 30


class RosoutListener:
    """A peer that hears /rosout and calls the logger services."""

    def __init__(self, peer):
        self.peer, self.node = peer, peer.node
        self.heard = []
        self.node.create_subscription(Log, "/rosout", self.heard.append, ROSOUT)

    def of(self, text):
        return [one for one in list(self.heard) if one.msg.startswith(text)]

    def call(self, kind, name, request):
        client = self.node.create_client(kind, f"/edgevox/edgevox/{name}")
        assert client.wait_for_service(15)
        future = client.call_async(request)
        wait_until(future.done, name)
        return future.result()

    def set(self, **levels):
        asked = [LoggerLevel(name=n.replace("_", "."), level=v) for n, v in levels.items()]
        request = SetLoggerLevels.Request(levels=asked)
        return self.call(SetLoggerLevels, "set_logger_levels", request).results

    def get(self, *names):
        request = GetLoggerLevels.Request(names=names)
        got = self.call(GetLoggerLevels, "get_logger_levels", request).levels
        return {one.name: one.level for one in got}


@pytest.fixture(scope="module")
def resident(shared):
    return shared(*JSON)


@pytest.fixture
def listener(robot):
    return RosoutListener(robot)


def logged(agent):
    """The lines of its log; what is printed for people stands between them."""
    return [json.loads(line) for line in agent.lines if line.startswith("{")]


def test_a_warning_of_ours_is_on_rosout_once_as_the_nodes_and_once_in_the_stream(
    resident, listener
):
    before = len(logged(resident))
    listener.peer.send("set_language", "klingon")
    wait_until(lambda: listener.of("message_refused"), "the warning on /rosout")
    listener.peer.send("set_language", "romulan")
    wait_until(lambda: len(listener.of("message_refused")) == 2, "the other one")
    said = listener.of("message_refused")[0]
    assert said.name == "edgevox.edgevox.ros2.bridge"
    assert said.level == WARN
    assert "klingon" in said.msg
    assert said.file.endswith("bridge.py")
    assert said.stamp.sec > 0
    resident.wait_for_line("romulan")
    refused = [line for line in logged(resident)[before:] if line["event"] == "message_refused"]
    assert [line["topic"] for line in refused] == ["set_language", "set_language"]
    plain = [line for line in resident.lines if not line.startswith(("{", "ROS 2: ", "robot-"))]
    assert plain == []


def test_levels_are_set_and_told_by_the_nodes_services_for_both_worlds(resident, listener):
    listener.peer.send("text_input", "where are you")
    assert [r.successful for r in listener.set(edgevox=DEBUG, rcl=DEBUG, httpx=WARN)] == [True] * 3
    wanted = {"edgevox": DEBUG, "rcl": DEBUG, "httpx": WARN, "edgevox.voice": 0}
    assert listener.get(*wanted) == wanted
    assert listener.get("") == {"": WARN}
    listener.peer.send("text_input", "where are you")
    resident.wait_for_line('"event":"state"')
    resident.wait_for_line('"logger":"rcl"')
    assert [r.successful for r in listener.set(edgevox=0, edgevox_edgevox=WARN)] == [True, True]
    assert listener.get("edgevox", "edgevox.edgevox") == {"edgevox": WARN, "edgevox.edgevox": WARN}
    (refused,) = listener.set(edgevox=7)
    assert not refused.successful
    assert "expected one of 0, 10, 20" in refused.reason
    listener.set(edgevox_edgevox=0, rcl=0)


def test_a_whole_run_is_json_and_tells_no_words_where_levels_come_from_ros_2s_arguments(
    agent, peer
):
    listener = RosoutListener(peer())
    levels = ("--ros-args", "--log-level", "edgevox:=info", "--log-level", "rcl:=debug")
    one = agent(*JSON, *levels)
    answers = listener.peer.listen("response")
    state = listener.peer.listen("robot_state", STATE)
    listener.peer.send("text_input", f"my name is {SECRET}")
    answers.wait_for(bool)
    listener.peer.send("text_input", "go to the kitchen")
    state.wait_for(lambda text: json.loads(text)["velocity"]["linear"] > 0.05)
    listener.peer.send("text_input", f"stop {SECRET}")
    one.wait_for_line("goal_cancelled")
    wait_until(lambda: listener.of("goal_cancelled"), "the end on /rosout")
    assert one.terminate() == 0
    lines = logged(one)
    events = [line["event"] for line in lines]
    for event in ("ready", "turn_began", "turn_ended", "safety_stop", "program_ended"):
        assert event in events
    (shut,) = [line for line in lines if line["event"] == "shutting_down"]
    assert shut["reason"] == "SIGTERM"
    assert "rcl" in {line["logger"] for line in lines}
    assert all(line["turn"] for line in lines if line["event"] == "goal_started")
    assert "xyzzy" not in one.output
    assert "xyzzy" not in "".join(said.msg for said in listener.heard)


def test_a_peer_whose_qos_does_not_fit_is_warned_of_on_both_of_its_ways(resident, listener):
    node = listener.peer.node
    lasting = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    careless = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)

    node.create_subscription(String, listener.peer.name("bot_sentence"), lambda _: None, lasting)
    node.create_publisher(String, listener.peer.name("text_input"), careless)

    resident.wait_for_line("New subscription discovered on topic 'bot_sentence'")
    resident.wait_for_line("New publisher discovered on topic 'text_input'")
