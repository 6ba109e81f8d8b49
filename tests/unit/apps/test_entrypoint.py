"""What the container's entrypoint makes of its environment. Wrong: tests/wrong/environment."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from edgevox.apps.container import ENVIRONMENT, prepared
from edgevox.apps.container import environment as robot_folder
from edgevox.apps.container.start import command_of, main
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def _ros(tmp_path, monkeypatch):
    """A ROS 2 that has one middleware."""
    index = tmp_path / "share/ament_index/resource_index/rmw_typesupport"
    index.mkdir(parents=True)
    (index / "rmw_fastrtps_cpp").touch()
    (index / "rmw_implementation").touch()  # loads one of the others
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))


def _prepared(**environment):
    return prepared(environment, lambda text: pytest.fail(f"warned: {text}"))


def test_with_nothing_given_it_is_a_silent_robot_on_domain_0():
    environment = _prepared()
    assert environment["ROS_DOMAIN_ID"] == "0"
    assert environment["EDGEVOX_AUDIO_IN"] == environment["EDGEVOX_AUDIO_OUT"] == "none"
    assert environment["EDGEVOX_TEXT_MODE"] == "true"
    assert command_of([], environment) == ["edgevox-agent", "robot-apartment", "--ros2"]


def test_variables_become_the_settings_that_they_name():
    environment = _prepared(
        EDGEVOX_NAMESPACE="/robot1", EDGEVOX_MUTED="true", EDGEVOX_LANGUAGE="fr"
    )
    assert environment["EDGEVOX_AGENT_NAMESPACE"] == "/robot1"
    assert "EDGEVOX_NAMESPACE" not in environment
    assert environment["EDGEVOX_MUTED"] == "true"
    assert environment["EDGEVOX_LANGUAGE"] == "fr"


def test_what_is_not_in_the_table_is_left_alone():
    assert _prepared(PATH="/bin", HTTP_PROXY="")["PATH"] == "/bin"


def test_an_empty_variable_counts_as_not_given():
    empty = _prepared(**dict.fromkeys(ENVIRONMENT, ""))
    assert empty == _prepared()


@pytest.mark.parametrize("given", ["EDGEVOX_AUDIO_IN", "EDGEVOX_AUDIO_OUT"])
def test_with_sound_in_one_direction_it_is_not_in_text_mode(given):
    environment = _prepared(**{given: "default"})
    assert environment[given] == ""  # what the setting calls the default device
    assert "EDGEVOX_TEXT_MODE" not in environment


@pytest.mark.parametrize(("name", "value"), [("ROS_DOMAIN_ID", "300"), ("EDGEVOX_LANGUAGE", "xx")])
def test_nonsense_stops_it_with_one_line_and_exit_code_64(name, value, monkeypatch, capsys):
    monkeypatch.setenv(name, value)
    assert main(["true"]) == 64
    said = capsys.readouterr()
    assert said.err.startswith(f"edgevox: {name}: got {value!r}, expected ")
    assert said.err.count("\n") == 1
    assert not said.out


def test_the_doctor_starts_in_spite_of_nonsense_but_never_without_the_security_asked_for(
    monkeypatch, capsys
):
    ran = []
    monkeypatch.setattr(os, "execvpe", lambda *command: ran.append(command[1]) or exit(0))
    monkeypatch.setenv("EDGEVOX_AGENT", "robot-paletta")
    with pytest.raises(SystemExit):
        main(["edgevox", "doctor", "--bundle", "-"])
    assert ran == [["edgevox", "doctor", "--bundle", "-"]]
    assert "EDGEVOX_AGENT: got 'robot-paletta'" in capsys.readouterr().err
    monkeypatch.setenv("EDGEVOX_SECURITY_KEYSTORE", "/nowhere")
    assert main(["edgevox", "doctor"]) == 64


@given(st.sampled_from(sorted(ENVIRONMENT)), st.text(st.characters(exclude_characters="\0")))
def test_any_text_in_any_variable_is_taken_or_refused_by_its_name(name, text):
    refused = None
    try:
        prepared({name: text}, lambda _: None)
    except InvalidValue as error:
        refused = error.field
    assert refused in (None, name)


@pytest.mark.parametrize(
    ("given", "warning"),
    [
        ({"ROS_DOMAIN_ID": "150"}, "ROS_DOMAIN_ID=150: Linux may hand its ports to other programs"),
        (
            {"EDGEVOX_LANGAUGE": "fr"},
            "EDGEVOX_LANGAUGE is no variable of EdgeVox and changes nothing;",
        ),
    ],
)
def test_what_is_odd_but_allowed_is_said(given, warning):
    said = []
    prepared(given, said.append)
    assert [line[: len(warning)] for line in said] == [warning]


@pytest.mark.parametrize(
    "name",
    ["EDGEVOX_PORT", "EDGEVOX_SERVICE_HOST", "EDGEVOX_METRICS_PORT_9100_TCP_ADDR", "EDGEVOX_UID"],
)
def test_what_kubernetes_and_compose_set_is_no_misspelling(name):
    _prepared(**{name: "x"})


@pytest.mark.parametrize(
    ("arguments", "agent", "command"),
    [
        (["bash", "-c", "echo $HOME"], "robot-panda", ["bash", "-c", "echo $HOME"]),
        ([], "robot-panda", ["edgevox-agent", "robot-panda", "--ros2"]),
        (
            ["--llm", "none"],
            "robot-panda",
            ["edgevox-agent", "robot-panda", "--ros2", "--llm", "none"],
        ),
        ([], "none", ["edgevox", "--ros2"]),
        ([], "edgevox", ["edgevox", "--ros2"]),
    ],
)
def test_arguments_are_a_command_and_flags_are_the_agents(arguments, agent, command):
    assert command_of(arguments, _prepared(EDGEVOX_AGENT=agent)) == command


@pytest.mark.parametrize(("command", "code"), [("no-such-thing", 127), (str(ROOT), 126)])
def test_a_command_that_cannot_run_is_told_as_shells_do(command, code, capsys):
    assert main([command]) == code
    assert re.fullmatch(r"edgevox: .+\n", capsys.readouterr().err)


def test_a_command_gets_its_arguments_untouched_and_the_environment_made_good():
    asked = "import os, sys; print(sys.argv[1:], os.environ['EDGEVOX_AGENT_NAMESPACE'])"
    start = [sys.executable, "-m", "edgevox.apps.container.start"]
    others = {name: value for name, value in os.environ.items() if not name.startswith("EDGEVOX_")}
    ran = subprocess.run(
        [*start, sys.executable, "-c", asked, "two words", "$HOME", "; true"],
        env={**others, "EDGEVOX_NAMESPACE": "/robot7"},
        capture_output=True,
        text=True,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout == "['two words', '$HOME', '; true'] /robot7\n"


def test_every_setting_has_a_row_and_every_row_says_what_it_is():
    assert {row.setting for row in ENVIRONMENT.values()} >= set(Settings.model_fields)
    assert all(
        row.sentence and (row.type != "integer" or row.values) for row in ENVIRONMENT.values()
    )


OF_THE_HOST = {"EDGEVOX_MODELS_DIR"}
"""It names a folder of the host, for docker/image and programs there."""


def test_compose_passes_on_every_variable_and_none_that_is_not_in_the_table():
    compose = yaml.safe_load((ROOT / "docker-compose.ros2.yml").read_text())
    passed = set(compose["services"]["edgevox-ros2"]["environment"])
    assert passed == set(ENVIRONMENT) - OF_THE_HOST


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "robot"
    made.mkdir()
    return made


def test_each_file_of_a_robots_folder_is_as_if_its_variable_were_set(folder):
    for name in ("robot.yaml", "world.yaml", "places.yaml", "policy.yaml", "README.md"):
        (folder / name).touch()
    for name in ("plugins", "scenarios"):
        (folder / name).mkdir()
    environment = _prepared(EDGEVOX_ROBOT_FOLDER=str(folder))
    assert {k: v for k, v in environment.items() if v.startswith(f"{folder}/")} == {
        "EDGEVOX_ROBOT_FILE": f"{folder}/robot.yaml",
        "EDGEVOX_WORLD": f"{folder}/world.yaml",
        "EDGEVOX_LOCATIONS": f"{folder}/places.yaml",
        "EDGEVOX_POLICY": f"{folder}/policy.yaml",
        "EDGEVOX_PLUGINS": f"{folder}/plugins",
    }
    assert command_of([], environment)[:2] == ["edgevox-agent", "robot-external"]


def test_a_folder_with_only_a_world_is_a_simulated_robot_and_what_is_set_counts_more(folder):
    (folder / "world.yaml").touch()
    given = {"EDGEVOX_ROBOT_FOLDER": str(folder)}
    assert _prepared(**given)["EDGEVOX_AGENT"] == "robot-apartment"
    (other := folder.parent / "other.yaml").touch()
    given |= {"EDGEVOX_WORLD": str(other), "EDGEVOX_AGENT": "robot-irsim"}
    environment = _prepared(**given)
    assert environment["EDGEVOX_WORLD"] == str(other)
    assert environment["EDGEVOX_AGENT"] == "robot-irsim"


def test_plug_ins_that_are_mounted_are_taken_unless_something_else_is_named(folder, monkeypatch):
    mounted, own = folder / "mounted", folder / "robot" / "plugins"
    own.mkdir(parents=True)
    monkeypatch.setattr(robot_folder, "MOUNTED", mounted)
    assert "EDGEVOX_PLUGINS" not in _prepared()
    mounted.mkdir()
    assert _prepared()["EDGEVOX_PLUGINS"] == str(mounted)
    assert _prepared(EDGEVOX_ROBOT_FOLDER=str(own.parent))["EDGEVOX_PLUGINS"] == str(own)
    other = folder / "other"
    other.mkdir()
    assert _prepared(EDGEVOX_PLUGINS=str(other))["EDGEVOX_PLUGINS"] == str(other)


def test_a_slip_in_a_name_in_a_robots_folder_is_told(folder):
    (folder / "robot.yml").touch()
    (folder / "Makefile").touch()
    said = []
    prepared({"EDGEVOX_ROBOT_FOLDER": str(folder)}, said.append)
    assert said == ["EDGEVOX_ROBOT_FOLDER: nothing reads robot.yml; did you mean robot.yaml?"]


def test_what_only_loads_a_middleware_is_none():
    with pytest.raises(InvalidValue, match="one of rmw_fastrtps_cpp$"):
        _prepared(RMW_IMPLEMENTATION="rmw_implementation")
