"""The vertical slice, between two processes: a string on a topic moves the robot."""

import json

import phrases
import pytest
from peer import SENSOR, STATE
from robot_states import far_room, moving, standing


@pytest.fixture
def far(robot):
    """A room that the robot needs a while to drive to."""
    return far_room(robot.listen("robot_state", STATE).wait_for(lambda _: True))


def in_room(room):
    return lambda message: json.loads(message)["room"] == room


def test_go_to_a_room_drives_the_robot_there_for_everybody_to_see(robot, far):
    agent_event = robot.listen("agent_event")
    robot_state = robot.listen("robot_state", STATE)
    response = robot.listen("response")
    sentence = robot.listen("bot_sentence")
    state = robot.listen("state", STATE)
    metrics = robot.listen("metrics")
    transcription = robot.listen("transcription")
    state.wait_for(lambda m: m == "listening")

    robot.send("text_input", f"go to {far}")

    transcription.wait_for(lambda m: m == f"go to {far}")
    agent_event.wait_for(lambda m: json.loads(m)["kind"] == "tool_call")
    response.wait_for(lambda m: m == phrases.begins("navigate_to", room=far))
    sentence.wait_for(lambda m: m == phrases.begins("navigate_to", room=far))
    measured = json.loads(metrics.wait_for(lambda m: True))
    assert set(measured) == {"stt", "llm", "tts", "ttfs", "total"}
    robot_state.wait_for(in_room(far))
    response.wait_for(lambda m: m == phrases.done("navigate_to", room=far))
    said = ["listening", "thinking", "speaking", "listening", "speaking", "listening"]
    state.wait_for(lambda m: True, since=len(said) - 1)
    assert state.messages == said
    assert response.messages == [
        phrases.begins("navigate_to", room=far),
        phrases.done("navigate_to", room=far),
    ]
    goals = [json.loads(m) for m in agent_event.messages]
    statuses = [g["status"] for g in goals if g["kind"] == "skill_goal"]
    assert statuses[0] == "accepted"
    assert statuses[-1] == "succeeded"
    assert {g["skill"] for g in goals} == {"navigate_to"}

    late_state = robot.listen("state", STATE)
    late_robot_state = robot.listen("robot_state", STATE)
    assert late_state.wait_for(lambda m: True) == "listening"
    assert json.loads(late_robot_state.wait_for(lambda m: True))["room"] == far


def test_stop_halts_the_driving_robot(robot, far):
    robot_state = robot.listen("robot_state", STATE)
    agent_event = robot.listen("agent_event")
    response = robot.listen("response")
    robot.send("text_input", f"go to the {far}")
    robot_state.wait_for(moving)
    robot.send("text_input", "stop")
    preempt = agent_event.wait_for(lambda m: json.loads(m)["kind"] == "safety_preempt")
    assert json.loads(preempt)["word"] == "stop"
    agent_event.wait_for(lambda m: json.loads(m)["kind"] == "skill_cancelled")
    response.wait_for(lambda m: m == phrases.said("stopped"))
    robot_state.wait_for(standing, since=len(robot_state.messages))


def test_interrupt_stops_the_robot_and_leaves_it_listening(robot, far):
    robot_state = robot.listen("robot_state", STATE)
    state = robot.listen("state", STATE)
    robot.send("text_input", f"go to the {far}")
    robot_state.wait_for(moving)
    heard = len(state.messages)
    for _ in range(10):
        robot.send("interrupt", "now")
    state.wait_for(lambda m: m == "interrupted", since=heard)
    robot_state.wait_for(standing, since=len(robot_state.messages))
    state.wait_for(lambda m: m == "listening", since=state.messages.index("interrupted", heard))


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("", phrases.said("not_heard")),
        ("go to the moon", phrases.opening("unknown_word", argument="room", said="moon")),
        ("go to", phrases.opening("missing_word", argument="room")),
        ("a" * 100_000, phrases.said("too_long", length=100_000, limit=2000)),
        ("drive to x 50 y 50", phrases.opening("failed")),
    ],
)
def test_bad_input_is_answered_and_the_process_goes_on(robot, text, answer):
    response = robot.listen("response")
    robot.send("text_input", text)
    response.wait_for(lambda m: m.startswith(answer))
    robot.send("text_input", "where are you")
    response.wait_for(lambda m: m.startswith("I am in the"))


def test_text_that_is_not_utf_8_is_answered_and_the_process_goes_on(robot):
    response = robot.listen("response")
    words = b"go to \xff\xfe\x00"
    cdr = b"\x00\x01\x00\x00" + len(words).to_bytes(4, "little") + words
    robot.send("text_input", cdr)
    response.wait_for(lambda m: m.startswith(phrases.opening("missing_word", argument="room")))
    robot.send("text_input", "where are you")
    response.wait_for(lambda m: m.startswith("I am in the"))


def test_an_unknown_command_is_refused_and_reset_stops_the_robot(resident, robot, far):
    robot_state = robot.listen("robot_state", STATE)
    robot.send("command", "self_destruct")
    resident.wait_for_line("command: got 'self_destruct', expected one of reset")
    robot.send("text_input", f"go to the {far}")
    robot_state.wait_for(moving)
    robot.send("command", "reset")
    robot_state.wait_for(standing, since=len(robot_state.messages))


def test_a_subscriber_of_tokens_is_served_best_effort(robot):
    robot.listen("bot_token", SENSOR)
    (token,) = robot.node.get_publishers_info_by_topic("/edgevox/bot_token")
    assert token.qos_profile.reliability.name == "BEST_EFFORT"
    (state,) = robot.node.get_publishers_info_by_topic("/edgevox/state")
    assert state.qos_profile.durability.name == "TRANSIENT_LOCAL"
