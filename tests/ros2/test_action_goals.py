"""The action's whole life, between two contexts: a served conversation and an rclpy client."""

import json
import threading

import phrases
import pytest
from action_rig import ActionRig, Client
from waiting import wait_until

from edgevox.core.commands import Interrupt


@pytest.fixture
def rig(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    rig = ActionRig()
    yield rig
    rig.close()
    left = {thread.name for thread in threading.enumerate()}
    assert not [one for one in left if one.startswith(("edgevox-goals", "edgevox-ros2"))]


@pytest.fixture
def client(rig, peer):
    one = Client(peer())
    yield one
    one.destroy()


def test_a_goal_succeeds_with_its_result_as_json_that_every_parser_reads(rig, client):
    goal = client.send("navigate_to", room="the Kitchen")
    assert goal.accepted
    rig.driving()
    rig.body.arrive()
    end, result = client.end_of(goal)
    assert (end, result.ok, result.error) == ("succeeded", True, "")
    assert json.loads(result.result_json) == {"room": "kitchen", "far": None}
    assert rig.goals("navigate_to") == ["accepted", "running", "succeeded"]


def test_feedback_mirrors_the_agent_events_of_the_same_goal_id(rig, client):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    wait_until(lambda: any("feedback" in f for f in client.feedback), "progress")
    rig.body.arrive()
    client.end_of(goal)
    wait_until(lambda: client.feedback[-1]["status"] == "succeeded", "the last feedback")
    progress = next(f for f in client.feedback if "feedback" in f)
    assert progress.pop("progress") == 0.5
    assert progress in rig.events
    assert {f["goal_id"] for f in client.feedback} == {bytes(goal.goal_id.uuid).hex()}
    reports = [d for d in rig.events if "feedback" in d]
    assert len(client.feedback) < len(reports)


def test_cancel_ends_a_running_goal_as_canceled(rig, client):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    assert client.cancel(goal) == 1
    end, result = client.end_of(goal)
    assert (end, result.ok, result.error) == ("canceled", False, phrases.why("client_asked"))
    assert not rig.conversation.wait_idle(0) or rig.goals("navigate_to")[-1] == "cancelled"


def test_a_second_goal_preempts_the_first_which_ends_as_canceled(rig, client):
    first = client.send("navigate_to", room="kitchen")
    rig.driving()
    second = client.send("navigate_to", room="bedroom")
    end, result = client.end_of(first)
    assert (end, result.error) == ("canceled", phrases.why("preempted", skill="navigate_to"))
    rig.driving()
    rig.body.arrive()
    assert client.end_of(second)[0] == "succeeded"


def test_a_sentence_preempts_a_goal(rig, client):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    rig.say("go to the bedroom")
    assert client.end_of(goal)[0] == "canceled"
    rig.driving()
    rig.body.arrive()
    assert rig.conversation.wait_idle(10)
    assert rig.said == ["Going to the bedroom.", "I am in the bedroom."]


def test_a_goal_preempts_what_was_asked_for_in_words_and_is_not_spoken_of(rig, client):
    rig.say("go to the bedroom")
    rig.driving()
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    rig.body.arrive()
    assert client.end_of(goal)[0] == "succeeded"
    assert rig.conversation.wait_idle(10)
    assert rig.said == ["Going to the bedroom."]
    assert "cancelled" in rig.goals("navigate_to")


def test_a_skill_that_moves_nothing_leaves_a_drive_alone(rig, client):
    drive = client.send("navigate_to", room="kitchen")
    rig.driving()
    end, result = client.end_of(client.send("get_pose"))
    assert (end, json.loads(result.result_json)) == ("succeeded", {"x": 1.25})
    rig.body.arrive()
    assert client.end_of(drive)[0] == "succeeded"


def test_a_skill_that_fails_aborts_its_goal_with_the_reason(rig, client):
    end, result = client.end_of(client.send("open_door"))
    assert (end, result.ok, result.error) == ("aborted", False, "the door is locked")
    assert result.result_json == "{}"


@pytest.mark.parametrize("stop", ["stop", None])
def test_a_stop_word_and_an_interrupt_end_a_goal_as_canceled(rig, client, stop):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    if stop:
        rig.say(stop)
    else:
        rig.conversation.submit(Interrupt())
    end, result = client.end_of(goal)
    assert end == "canceled"
    assert result.error == (
        phrases.why("heard_stop", word="stop") if stop else phrases.why("interrupted")
    )


@pytest.mark.parametrize(
    ("name", "arguments", "reason"),
    [
        ("fly", "{}", "skill: got 'fly', expected one of navigate_to, open_door, get_pose"),
        ("navigate_to", '{"room": "moon"}', "navigate_to.room: got 'moon', expected 'kitchen'"),
        ("navigate_to", "{}", "navigate_to.room: got None, expected a value"),
        ("navigate_to", '{"room": ', "arguments_json: got "),
        ("navigate_to", '["kitchen"]', "expected a JSON object, keyword to value"),
        ("get_pose", '{"x": NaN}', "expected finite numbers; NaN is none"),
        ("get_pose", '{"x": "\\ud800"}', "expected valid JSON"),
        ("get_pose", "[" * 60_000, "expected valid JSON"),
        ("navigate_to", '{"room": "moon", "room": "kitchen"}', "'room' is there more than once"),
        ("get_pose", " " * 70_000, "expected at most 65536 bytes"),
    ],
)
def test_a_goal_that_cannot_be_is_rejected_with_its_reason(rig, client, name, arguments, reason):
    assert not client.send(name, arguments).accepted
    (event,) = [d for d in rig.events if d.get("status") == "rejected"]
    assert reason in event["error"]
    assert (event["kind"], event["skill"], event["goal_id"]) == ("skill_goal", name, None)
    assert client.end_of(client.send("get_pose"))[0] == "succeeded"


def test_a_rejected_goal_leaves_a_running_one_alone(rig, client):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    assert not client.send("navigate_to", room="moon").accepted
    rig.body.arrive()
    assert client.end_of(goal)[0] == "succeeded"


def test_fifty_goals_at_once_all_end_and_the_last_one_wins(rig, client):
    goals = client.send_all([("navigate_to", '{"room": "kitchen"}')] * 50)
    assert all(goal.accepted for goal in goals)
    rig.body.arrive()
    ends = [end for end, _ in client.ends_of(goals)]
    assert set(ends) <= {"succeeded", "canceled"}
    assert "succeeded" in ends
    assert rig.conversation.wait_idle(10)


def test_shutting_down_ends_a_goal_as_canceled_for_its_client(rig, client):
    goal = client.send("navigate_to", room="kitchen")
    rig.driving()
    rig.conversation.close()
    end, result = client.end_of(goal)
    assert (end, result.error) == ("canceled", phrases.why("shutting_down"))


def test_a_client_that_leaves_ends_its_goal(rig, client):
    client.send("navigate_to", room="kitchen")
    rig.driving()
    client.destroy()
    assert rig.conversation.wait_idle(30)
    assert rig.events[-1]["reason"] == phrases.why("client_gone")
