"""The action of a real agent: with its robot, without its interface, and when a side dies."""

import json
import sys

import phrases
import pytest
from action_rig import Client
from guards import run_program
from peer import RELIABLE, STATE
from robot_states import far_room, moving, standing


def test_a_goal_drives_the_robot_to_its_room(robot):
    client = Client(robot)
    response = robot.listen("response")
    room = far_room(robot.listen("robot_state", STATE).wait_for(lambda _: True))
    goal = client.send("navigate_to", room=room)
    end, result = client.end_of(goal)
    assert (end, json.loads(result.result_json)["room"]) == ("succeeded", room)
    assert any(f.get("progress", 0) > 0 for f in client.feedback)
    robot.send("text_input", "where are you")
    response.wait_for(lambda m: m.startswith(phrases.stands(room=room)))
    # Its client knows; nobody else asked.
    assert phrases.done("navigate_to", room=room) not in response.messages


def test_cancel_and_stop_leave_the_robot_standing(robot):
    client = Client(robot)
    state = robot.listen("robot_state", STATE)
    for end_it in (client.cancel, lambda goal: robot.send("text_input", "stop")):
        room = far_room(state.wait_for(standing, since=len(state.messages)))
        goal = client.send("navigate_to", room=room)
        state.wait_for(moving, since=len(state.messages))
        end_it(goal)
        assert client.end_of(goal)[0] == "canceled"
        state.wait_for(standing, since=len(state.messages))


@pytest.mark.parametrize(
    ("skill", "arguments", "reason"),
    [
        ("navigate_to", '{"room": "moon"}', "navigate_to.room: got 'moon'"),
        ("navigate_xy", '{"x": true, "y": 1}', "navigate_xy.x: got True, expected a valid number"),
        ("navigate_xy", '{"x": "5", "y": "1"}', "navigate_xy.x: got '5', expected a valid number"),
        ("navigate_xy", '{"x": 2, "y": 1, "x": 3}', "'x' is there more than once"),
        (
            "navigate_xy",
            '{"x": 1e308, "y": 1}',
            "outside the apartment: x must be between 0 and 10",
        ),
        ("navigate_xy", '{"x": 50, "y": 1}', "outside the apartment: x must be between 0 and 10"),
    ],
)
def test_values_that_no_goal_can_have_are_rejected_before_the_robot_moves(
    robot, skill, arguments, reason
):
    event = robot.listen("agent_event", RELIABLE)
    state = robot.listen("robot_state", STATE)
    assert not Client(robot).send(skill, arguments).accepted
    told = json.loads(event.wait_for(lambda m: json.loads(m).get("status") == "rejected"))
    assert reason in told["error"]
    state.wait_for(standing, since=len(state.messages))
    assert all(json.loads(m).get("status") == "rejected" for m in event.messages)


@pytest.mark.long
def test_goals_of_a_remapped_action_have_a_client_a_log_and_an_end_with_the_agent(agent, peer):
    parts = ("send_goal", "get_result", "cancel_goal", "feedback", "status")
    rules = [f"execute_skill/_action/{part}:=do/_action/{part}" for part in parts]
    one = agent("--ros-args", *(flag for rule in rules for flag in ("-r", rule)))
    robot = peer()
    client = Client(robot, "/edgevox/do")
    assert client.end_of(client.send("navigate_to", room="living_room"))[0] == "succeeded"

    # Not of the shared agent, whose log leaves out what others were refused too often.
    assert not client.send("navigate_to", room="moon").accepted
    line = one.wait_for_line("action_goal_rejected")
    assert "skill=navigate_to" in line
    assert "navigate_to.room: got 'moon'" in line

    state = robot.listen("robot_state", STATE)
    goal = client.send("navigate_to", room="bedroom")
    state.wait_for(moving)
    (answer,) = client.ask_ends_of([goal])
    assert one.terminate() == 0
    assert client.answer(answer)[0] == "canceled"
    assert "Traceback" not in one.output


def test_without_edgevox_msgs_one_line_says_so_and_the_agent_works():
    program = (
        "import sys; sys.modules['edgevox_msgs'] = None\n"
        "from edgevox.apps.agent.main import main; sys.exit(main())"
    )
    done = run_program(
        [sys.executable, "-c", program, "robot-apartment", "--text-mode", "--ros2", "--llm=none"],
        input="where are you\n",
    )
    assert done.returncode == 0
    said = done.stdout + done.stderr
    assert said.count("action=execute_skill reason='edgevox_msgs is not built; make msgs'") == 1
    assert "I am in the" in done.stdout
