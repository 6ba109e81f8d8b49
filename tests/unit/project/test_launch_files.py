import argparse
import os
import sys
from pathlib import Path

import pytest
from launch_stand_in import LAUNCH, LaunchDescription, Node, load

from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.robots import ROBOTS
from edgevox.core.settings import Settings

FILES = sorted(LAUNCH.glob("*.launch.py"))
CONTRACT = {
    "edgevox.launch.py": {"namespace", "language"},
    "edgevox_irsim.launch.py": {"namespace"},
    "edgevox_panda.launch.py": {"namespace", "state_hz"},
    "edgevox_humanoid.launch.py": {"namespace", "model_source", "mjcf"},
    "edgevox_external.launch.py": {"namespace", "external_namespace", "locations"},
}
OLD = {"namespace": "agent_namespace", "external_namespace": "robot_namespace"}
SWITCHES = {name for name, field in Settings.model_fields.items() if field.annotation is bool}
NO_FLAGS = {"robot", "agent_namespace", "params_file", "config", *OLD}
"""Arguments that are no setting, and old names of those that are."""


@pytest.fixture(params=FILES, ids=lambda file: file.name)
def description(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch):
    return load(request.param, monkeypatch)["generate_launch_description"]()


def started(description: LaunchDescription, **given: str) -> Node:
    (node,) = description.nodes(**given)
    return node


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_importing_a_launch_file_does_nothing(
    file: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    before = dict(os.environ)
    known = {name for name in sys.modules if name.startswith(("rclpy", "edgevox"))}

    load(file, monkeypatch)

    assert dict(os.environ) == before
    assert {name for name in sys.modules if name.startswith(("rclpy", "edgevox"))} == known
    assert capfd.readouterr() == ("", "")


def test_a_launch_file_runs_an_executable_of_the_package(description: LaunchDescription) -> None:
    node = started(description)
    assert (node.package, node.executable) == ("edgevox", "edgevox-agent")
    assert node.output == "screen"


@pytest.mark.parametrize(("file", "promised"), CONTRACT.items())
def test_a_launch_file_takes_what_the_contract_says(
    file: str, promised: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    description = load(LAUNCH / file, monkeypatch)["generate_launch_description"]()
    assert set(description.arguments) >= promised


def test_every_launch_file_has_its_row_here() -> None:
    assert {file.name for file in FILES} == set(CONTRACT)


def test_every_argument_is_described(description: LaunchDescription) -> None:
    assert all(argument.description for argument in description.arguments.values())


def test_every_argument_reaches_the_process(description: LaunchDescription) -> None:
    plain = started(description).command
    for name in description.arguments.keys() - {"robot"} - SWITCHES:
        command = started(description, **{name: "/given"}).command
        changed = [word for word in command if word not in plain]
        assert any("/given" in word for word in changed), name


def test_any_robot_can_be_started_and_a_robots_own_launch_file_starts_that_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for file in FILES:
        description = load(file, monkeypatch)["generate_launch_description"]()
        robot = started(description, robot="another").arguments[0]
        own = "robot-" + file.name.removesuffix(".launch.py").removeprefix("edgevox").strip("_")
        assert robot == ("another" if own == "robot-" else own)


def test_without_arguments_the_process_keeps_its_own_defaults(
    description: LaunchDescription,
) -> None:
    robot = started(description).arguments[0]
    assert started(description).command == [
        "edgevox-agent",
        robot,
        "--ros2",
        "--ros-args",
    ]


def test_a_switch_can_be_turned_on_and_off(description: LaunchDescription) -> None:
    for name in description.arguments.keys() & SWITCHES:
        flag = name.replace("_", "-")
        assert f"--{flag}" in started(description, **{name: "true"}).arguments
        assert f"--no-{flag}" in started(description, **{name: "False"}).arguments


def test_a_switch_that_is_neither_is_refused(description: LaunchDescription) -> None:
    with pytest.raises(RuntimeError, match="render: got 'maybe', expected true or false"):
        started(description, render="maybe")


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_a_launch_file_starts_a_robot_that_there_is(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    description = load(file, monkeypatch)["generate_launch_description"]()
    assert started(description).arguments[0] in ROBOTS


def test_namespace_and_parameters_are_handed_on_as_ros_2_does(
    description: LaunchDescription,
) -> None:
    given = {"agent_namespace": "/robot1", "params_file": "/etc/robot1.yaml"}
    command = " ".join(started(description, **given).command)
    assert "--ros-args -r __ns:=/robot1" in command
    assert "--params-file /etc/robot1.yaml" in command


def test_the_process_takes_every_setting_and_describes_it_in_the_same_words(
    description: LaunchDescription,
) -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("robot")
    add_flags(parser)
    for name in description.arguments.keys() - NO_FLAGS:
        given = ("false", False) if name in SWITCHES else ("x", "x")
        node = started(description, **{name: given[0]})
        (field,) = (
            f
            for f, value in given_flags(parser.parse_args(node.arguments)).items()
            if value == given[1]
        )
        about = Settings.model_fields[field].description
        assert description.arguments[name].description == about


def test_the_namespace_and_the_file_of_settings_are_described_in_the_same_words(
    description: LaunchDescription,
) -> None:
    parser = argparse.ArgumentParser()
    add_flags(parser)
    assert f"{description.arguments['config'].description}\n" in parser.format_help()
    about = Settings.model_fields["agent_namespace"].description
    assert description.arguments["agent_namespace"].description == about


@pytest.mark.parametrize(("old", "new"), OLD.items())
def test_an_old_name_goes_on_working_and_is_told_to_be_one(
    description: LaunchDescription, old: str, new: str
) -> None:
    if new not in description.arguments:
        assert old not in description.arguments
        return
    assert description.arguments[old].description == f"old name of {new}"
    assert (
        started(description, **{old: "/a"}).command == started(description, **{new: "/a"}).command
    )
    assert started(description, **{old: "/a", new: "/a"}).command
    with pytest.raises(RuntimeError, match=f"{old}: got '/b', expected '/a', as {new} says"):
        started(description, **{old: "/b", new: "/a"})


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_no_launch_file_touches_the_domain(file: Path) -> None:
    assert "ROS_DOMAIN_ID" not in file.read_text(encoding="utf-8")
