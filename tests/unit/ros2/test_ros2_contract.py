"""The table in code promises exactly what the contract's YAML file promises."""

import ast
from dataclasses import fields
from pathlib import Path

import pytest
import yaml
from code_files import trees

import edgevox.ros2
from edgevox.core.agent_events import AgentEventKind, SafetyPreempted
from edgevox.core.commands import (
    CancelProgram,
    Interrupt,
    Query,
    Reset,
    SetMuted,
    Speak,
    TextInput,
)
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Answered, Cause, State, TurnMeasured
from edgevox.core.hearers import Claim
from edgevox.core.settings import Settings
from edgevox.ros2 import contract, split_ros_args, standard_topics

OWN_QOS = {"messages.py", "logs.py", "doctor.py", "skill_action.py"}
"""Where rclpy's class is made: of the contract's rows, and for what is no topic of the contract."""
PROMISED = yaml.safe_load(
    (Path(__file__).parents[2] / "ros2" / "contract.yaml").read_text(encoding="utf-8")
)


def qos_words(spec):
    return {
        "reliability": "reliable" if spec.reliable else "best_effort",
        "durability": "transient_local" if spec.transient_local else "volatile",
        "depth": spec.depth,
    }


def test_the_qualities_of_service_are_the_contracts():
    assert {one.name.lower(): qos_words(one.value) for one in contract.Qos} == PROMISED["qos"]


@pytest.mark.parametrize("side", ["published", "subscribed"])
def test_the_topics_are_the_contracts(side):
    rows = contract.PUBLISHED if side == "published" else contract.SUBSCRIBED
    assert {row.topic: (row.type, row.qos.name.lower()) for row in rows} == {
        topic: (row["type"], row["qos"]) for topic, row in PROMISED[side].items()
    }


def test_the_rates_are_the_contracts_and_that_of_the_robots_state_is_the_settings():
    promised = {
        topic: row["rate_hz"]
        for part in ("published", "robot_interop", "shared")
        for topic, row in PROMISED[part].items()
        if "rate_hz" in row
    }
    rates_hz = {row.topic: row.rate_hz for row in contract.RATED}
    assert promised.items() <= rates_hz.items()
    assert rates_hz["robot_state"] == Settings().ros2_state_hz


def test_the_topics_that_agents_share_are_the_contracts():
    ours = {row.topic: (row.type, row.qos.name.lower(), row.rate_hz) for row in contract.SHARED}
    assert ours == {
        topic: (row["type"], row["qos"], row.get("rate_hz", 0.0))
        for topic, row in PROMISED["shared"].items()
    }
    for key in PROMISED["shared"]["presence"]["json"]:
        assert key in contract.PRESENCE.about


def test_the_topic_of_a_group_is_the_contracts():
    ((topic, row),) = PROMISED["group"].items()
    ours = contract.HEARERS
    assert (ours.topic, ours.type, ours.qos.name.lower()) == (topic, row["type"], row["qos"])
    assert [one.name for one in fields(Claim)] == row["json"]
    for key in row["json"]:
        assert key in ours.about


def test_the_parameters_of_the_contract_are_there_with_their_defaults():
    ours = {row.name: row.default for row in contract.PARAMETERS}
    for name, row in PROMISED["parameters"].items():
        assert ours[name] == row["default"]


@pytest.mark.parametrize("row", contract.PARAMETERS, ids=lambda row: row.name)
def test_a_parameter_is_a_setting_and_begins_as_it_does(row):
    setting = Settings.model_fields[row.name]
    assert row.default == setting.default
    assert row.about == setting.description or not row.read_only


def test_no_module_declares_a_quality_of_service_or_a_rate_of_its_own():
    own = []
    for file, tree in trees(Path(edgevox.ros2.__file__).parent, having=r"QoSProfile|_HZ\b"):
        for node in ast.walk(tree):
            match node:
                case ast.Call(func=ast.Name(id="QoSProfile")) if file.name not in OWN_QOS:
                    own.append(f"{file}:{node.lineno}")
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant()):
                    own += [f"{file}:{node.lineno}"] if name.endswith("_HZ") else []
    assert own == [], "the contract has a row for it"


def test_the_commands_and_queries_are_the_contracts():
    assert set(contract.COMMANDS) == set(PROMISED["subscribed"]["command"]["values"])
    assert {name: list(keys) for name, keys in contract.QUERIES.items()} == PROMISED["queries"]


def test_the_states_and_kinds_of_events_are_the_contracts():
    assert [str(state) for state in State] == PROMISED["published"]["state"]["values"]
    kinds = [str(kind) for kind in AgentEventKind]
    assert kinds == PROMISED["published"]["agent_event"]["kinds"]


def test_the_robots_topics_are_the_contracts():
    ours = {row.topic: (row.type, row.direction, row.rate_hz) for row in standard_topics.INTEROP}
    for topic, row in PROMISED["robot_interop"].items():
        assert ours[topic] == (row["type"], row["dir"], row.get("rate_hz", 0.0))


def test_the_topics_of_an_external_robot_are_the_contracts():
    assert {row.topic: (row.type, row.direction) for row in standard_topics.EXTERNAL} == {
        topic: (row["type"], row["dir"]) for topic, row in PROMISED["external_robot"].items()
    }


def test_the_action_and_the_names_are_the_contracts():
    (action,) = PROMISED["actions"].items()
    assert (action[0], action[1]["type"]) == contract.ACTION
    assert PROMISED["node"] == contract.NODE_NAME
    assert PROMISED["default_namespace"] == Settings.model_fields["agent_namespace"].default


@pytest.mark.parametrize(
    ("topic", "text", "command"),
    [
        ("text_input", "hello", TextInput("hello")),
        ("tts_request", "hello", Speak("hello")),
        ("interrupt", "anything", Interrupt(cause=Cause.TOPIC)),
        ("command", " reset\n", Reset()),
        ("command", "mute", SetMuted(True)),
        ("command", "list_voices", Query("list_voices")),
        ("command", "list_programs", Query("list_programs")),
        ("command", "cancel_programs", CancelProgram()),
        ("command", " cancel_program  2f5c ", CancelProgram("2f5c")),
    ],
)
def test_a_string_becomes_its_command(topic, text, command):
    (row,) = [row for row in contract.SUBSCRIBED if row.topic == topic]
    assert row.decode(text) == command


def test_an_unknown_command_is_refused_with_those_that_exist():
    (row,) = [row for row in contract.SUBSCRIBED if row.topic == "command"]
    with pytest.raises(InvalidValue, match="command: got 'dance', expected one of reset, mute"):
        row.decode("dance")


@pytest.mark.parametrize(
    ("event", "text"),
    [
        (
            SafetyPreempted("halt", stopped=True),
            '{"kind": "safety_preempt", "word": "halt", "stopped": true, "heard_by": "words"}',
        ),
        (Answered("list_voices", {"voices": []}), '{"query": "list_voices", "voices": []}'),
        (
            TurnMeasured(0.0, 0.12345678, 0.0, 0.2, 0.3, turn=4),
            '{"stt": 0.0, "llm": 0.1235, "tts": 0.0, "ttfs": 0.2, "total": 0.3}',
        ),
    ],
)
def test_an_event_becomes_its_json(event, text):
    (row,) = [row for row in contract.PUBLISHED if isinstance(event, row.event)]
    assert row.encode(event) == text


@pytest.mark.parametrize(
    ("argv", "own", "ros"),
    [
        (["a", "--ros2"], ["a", "--ros2"], []),
        (["a", "--ros-args", "-r", "__ns:=/x"], ["a"], ["--ros-args", "-r", "__ns:=/x"]),
        (
            ["--ros-args", "-p", "muted:=true", "--", "a", "--ros2"],
            ["a", "--ros2"],
            ["--ros-args", "-p", "muted:=true", "--"],
        ),
        (
            ["a", "--ros-args", "-p", "x:=1", "--", "b", "--ros-args", "-r", "y:=z"],
            ["a", "b"],
            ["--ros-args", "-p", "x:=1", "--", "--ros-args", "-r", "y:=z"],
        ),
    ],
)
def test_ros_arguments_are_told_from_our_own(argv, own, ros):
    assert split_ros_args(argv) == (own, ros)
