"""It asks back: the parameter `confirm`, the event, and the answer by `text_input`."""

import json

import phrases
import pytest
from guards import HUNG_S
from peer import STATE
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParametersAtomically

NODE = "/edgevox/edgevox"
KITCHEN = {"skill": "navigate_to", "arguments": {"room": "kitchen"}}


class Robot:
    """An agent, and what a stranger hears of it."""

    def __init__(self, peer):
        self.peer = peer
        self.events = peer.listen("agent_event")
        self.response = peer.listen("response")
        self.state = peer.listen("robot_state", STATE)

    def say(self, text):
        self.peer.send("text_input", text)

    def wait_for(self, status):
        """The next question that is so far."""
        wanted = self.events.wait_for(lambda m: is_question(m, status))
        return json.loads(wanted)

    def statuses(self):
        events = map(json.loads, self.events.messages)
        return [one["status"] for one in events if one["kind"] == "confirmation"]

    def calls(self):
        return [m for m in self.events.messages if json.loads(m)["kind"] == "tool_call"]

    def set_confirm(self, value):
        text = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)
        wanted = [Parameter(name="confirm", value=text)]
        service = f"{NODE}/set_parameters_atomically"
        request = SetParametersAtomically.Request(parameters=wanted)
        return self.peer.call(SetParametersAtomically, service, request).result

    def confirm(self):
        request = GetParameters.Request(names=["confirm"])
        (value,) = self.peer.call(GetParameters, f"{NODE}/get_parameters", request).values
        return value.string_value


def is_question(message, status):
    event = json.loads(message)
    return event["kind"] == "confirmation" and event["status"] == status


@pytest.fixture(scope="module")
def resident(shared):
    return shared("--confirm", "always")


@pytest.fixture
def asking(robot):
    one = Robot(robot)
    yield one
    assert one.set_confirm("always").successful


def test_a_question_is_seen_and_a_yes_on_text_input_drives_the_robot(asking):
    assert asking.confirm() == "always"
    asking.say("go to the kitchen")
    asked = asking.wait_for("asked")
    assert asked == {
        "kind": "confirmation",
        "status": "asked",
        "question": phrases.asks("navigate_to", room="kitchen"),
        "calls": [KITCHEN],
        "expires_s": 20.0,
        "turn": asked["turn"],
        "goes": False,
    }
    asking.response.wait_for(lambda m: m == phrases.asks("navigate_to", room="kitchen"))
    assert asking.calls() == []
    asking.say("yes please")
    assert asking.wait_for("confirmed")["turn"] == asked["turn"]
    asking.response.wait_for(lambda m: m == phrases.begins("navigate_to", room="kitchen"))
    asking.state.wait_for(lambda m: json.loads(m)["room"] == "kitchen", timeout_s=HUNG_S)


def test_a_no_another_place_and_a_stop_are_answers_too(asking):
    asking.say("go to the kitchen")
    asking.wait_for("asked")
    asking.say("no, the bedroom")
    asking.wait_for("declined")
    asking.response.wait_for(lambda m: m == phrases.asks("navigate_to", room="bedroom"))
    asking.say("stop")
    asking.wait_for("cancelled")
    asking.say("yes")
    asking.response.wait_for(lambda m: m == phrases.said("nothing_asked"))
    assert asking.calls() == []
    assert asking.statuses() == ["asked", "declined", "asked", "cancelled"]


def test_the_parameter_changes_while_it_runs_and_refuses_what_it_cannot_be(asking):
    result = asking.set_confirm("sometimes")
    assert not result.successful
    assert result.reason == ("confirm: got 'sometimes', expected one of always, unsure, never")
    assert asking.confirm() == "always"
    asking.say("go to the kitchen")
    asking.wait_for("asked")
    asking.say("where are you")
    asking.wait_for("replaced")
    assert asking.set_confirm("never").successful
    asking.say("go to the kitchen")
    asking.response.wait_for(lambda m: m == phrases.begins("navigate_to", room="kitchen"))


def test_a_countdown_is_seen_and_goes_by_itself(agent, peer, tmp_path):
    policy = tmp_path / "policy.yaml"
    policy.write_text("rules: {text_input: {navigate_to: countdown}}\n")
    agent("--policy", str(policy))
    robot = Robot(peer())
    robot.say("go to the kitchen")
    asked = robot.wait_for("asked")
    assert (asked["goes"], asked["expires_s"], asked["calls"]) == (True, 1.0, [KITCHEN])
    robot.response.wait_for(lambda m: m == asked["question"])
    robot.wait_for("counted_down")
    robot.state.wait_for(lambda m: json.loads(m)["room"] == "kitchen", timeout_s=HUNG_S)
    assert robot.statuses() == ["asked", "counted_down"]
    assert len(robot.calls()) == 1
