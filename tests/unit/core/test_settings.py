import argparse
import ast
from collections import Counter
from pathlib import Path
from typing import get_args

import pytest
from code_files import trees

import edgevox
from edgevox.apps.flags import FIRST, GROUPS, add_flags, given_flags, group_of
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings, load_settings


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "edgevox.toml"

    def write(text):
        path.write_text(text)
        return path

    return write


def test_each_source_overrules_the_one_before(config, monkeypatch):
    path = config('language = "fr"\nros2_state_hz = 5\nllm_threads = 3')
    monkeypatch.setenv("EDGEVOX_ROS2_STATE_HZ", "20")
    monkeypatch.setenv("EDGEVOX_LLM_THREADS", "4")
    settings = load_settings({"llm_threads": "5"}, path)
    assert settings.language == "fr"
    assert settings.ros2_state_hz == 20
    assert settings.llm_threads == 5
    assert settings.agent_namespace == "/edgevox"


@pytest.mark.parametrize(
    ("written", "variable", "flags", "served"),
    [
        ("", None, {}, False),
        ("", None, {"console_optional": "true"}, True),
        ("console = false", None, {"console_optional": "true"}, False),
        ("console = true", None, {"console_optional": "true"}, True),
        ("console = true", None, {}, True),
        ("", "false", {"console_optional": "true"}, False),
        ("console = false", None, {"console": "true", "console_optional": "true"}, True),
        ("console_optional = true", None, {"console": "false"}, False),
    ],
)
def test_an_optional_console_is_served_unless_somebody_says_otherwise(
    config, monkeypatch, written, variable, flags, served
):
    if variable:
        monkeypatch.setenv("EDGEVOX_CONSOLE", variable)
    assert load_settings(flags, config(written)).serves_console is served


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ({"ros2_state_hz": "fast"}, "ros2_state_hz: got 'fast', expected a valid number"),
        (
            {"ros2_state_hz": "1000"},
            "ros2_state_hz: got '1000', expected less than or equal to 100",
        ),
        ({"language": "xx"}, "language: got 'xx', expected one of en, es"),
        (
            {"agent_namespace": "my robot"},
            "agent_namespace: got 'my robot', expected a ROS 2 namespace",
        ),
        ({"log_level": "loud"}, "log_level: got 'loud', expected 'debug', 'info'"),
    ],
)
def test_a_wrong_value_is_refused_by_field_value_and_expectation(flags, message):
    with pytest.raises(InvalidValue) as refused:
        load_settings(flags)
    assert str(refused.value).startswith(message)


def test_a_wrong_environment_variable_names_its_field(monkeypatch):
    monkeypatch.setenv("EDGEVOX_LLM_CONTEXT", "12")
    with pytest.raises(InvalidValue, match="llm_context: got '12', expected greater than or equal"):
        load_settings({})


def test_a_misspelled_key_in_the_file_is_refused_with_the_names_that_exist(config):
    with pytest.raises(InvalidValue, match="langauge: got 'fr', expected one of language, "):
        load_settings({}, config('langauge = "fr"'))


def test_a_file_that_is_not_toml_is_refused(config):
    with pytest.raises(EdgeVoxError, match="is not valid TOML"):
        load_settings({}, config("language ="))


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InvalidValue, match="config: .*No such file"):
        load_settings({}, tmp_path / "absent.toml")


def test_a_namespace_without_a_slash_is_made_absolute():
    assert load_settings({"agent_namespace": "robot1"}).agent_namespace == "/robot1"


def test_what_a_setting_may_be_chosen_from_is_written_down_once():
    choices = {get_args(field.annotation) for field in Settings.model_fields.values()} - {()}
    written = []
    for _, tree in trees(Path(edgevox.__file__).parent, having=r"\bLiteral\b"):
        for node in ast.walk(tree):
            match node:
                case ast.Subscript(value=ast.Name(id="Literal"), slice=ast.Tuple() as names):
                    written.append(ast.literal_eval(names))
    counts = Counter(written)
    assert counts["cancel", "gate", "none"] == 1
    assert [one for one in choices if counts[one] > 1] == []


def test_the_help_shows_every_flag_in_its_group_and_what_matters_first_first():
    parser = argparse.ArgumentParser()
    add_flags(parser)
    text = parser.format_help().partition("first of all:")[2]

    for name in FIRST:
        assert f"\n  --{name.replace('_', '-')}" in text.partition("conversation:")[0]
    at = [text.index(f"\n{title}:") for title in GROUPS]
    assert at == sorted(at)
    assert {group_of(name) for name in Settings.model_fields} == {"first of all", *GROUPS}


@pytest.mark.parametrize(
    ("flag", "field"),
    [
        ("--agent-namespace", "agent_namespace"),
        ("--ros2-namespace", "agent_namespace"),
        ("--robot-namespace", "robot_namespace"),
        ("--namespace", "robot_namespace"),
    ],
)
def test_a_flag_says_whose_namespace_it_is_and_its_old_name_goes_on_working(flag, field):
    parser = argparse.ArgumentParser()
    add_flags(parser)

    assert given_flags(parser.parse_args([flag, "/robot1"])) == {field: "/robot1"}


@pytest.mark.parametrize(
    ("old", "new"),
    [("ros2_namespace", "agent_namespace"), ("external_namespace", "robot_namespace")],
)
def test_a_variable_and_a_key_go_on_working_by_their_old_name(old, new, monkeypatch, tmp_path):
    file = tmp_path / "edgevox.toml"
    file.write_text(f'{old} = "/file"\n', encoding="utf-8")
    assert getattr(load_settings({}, file), new) == "/file"
    file.write_text(f'{old} = "/file"\n{new} = "/other"\n', encoding="utf-8")
    with pytest.raises(InvalidValue, match=f"{old}: got '/file', expected '/other', as {new} says"):
        load_settings({}, file)

    old, new_variable = f"EDGEVOX_{old.upper()}", f"EDGEVOX_{new.upper()}"
    monkeypatch.setenv(old, "/a")
    assert getattr(load_settings({}), new) == "/a"
    assert getattr(load_settings({new: "/flag"}), new) == "/flag"
    monkeypatch.setenv(new_variable, "/b")
    with pytest.raises(InvalidValue, match=f"{old}: got '/a', expected '/b', as {new_variable}"):
        load_settings({})


def test_two_values_by_a_flag_and_its_old_name_are_refused_with_both_names(capsys):
    parser = argparse.ArgumentParser()
    add_flags(parser)
    with pytest.raises(SystemExit):
        parser.parse_args(["--robot-namespace=/a", "--namespace=/b"])
    assert "--namespace: got '/b', but --robot-namespace says '/a'" in capsys.readouterr().err
