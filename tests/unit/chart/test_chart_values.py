"""Good values of the chart mean what they say. Wrong ones: tests/wrong/chart."""

import json
from typing import Any

import helm_python as helm
import pytest
import yaml
from chart_rig import ONE, chart, environment, pods, solo
from hypothesis import given, settings
from hypothesis import strategies as st

from edgevox.apps.container import ENVIRONMENT, prepared
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings, check_settings

FLEET = yaml.safe_load(chart.FLEET.read_text())


def robot(**fields: Any) -> dict[str, Any]:
    return {"robots": [{"name": "solo", "domain": 7, **fields}]}


def test_lint_refuses_what_install_would_refuse() -> None:
    report = helm.lint(str(chart.CHART), robot(domain=300), strict=True)

    assert [m for m in report["messages"] if "/robots/0/domain" in m["error"]]


@pytest.mark.parametrize("name", ["robot1", "robot2", "robot3"])
def test_what_the_chart_sets_is_what_the_entrypoint_takes_without_a_word(name: str) -> None:
    given = environment(pods(FLEET)[name])
    warnings: list[str] = []

    made = prepared(given, warnings.append)

    assert warnings == []
    assert given.keys() <= ENVIRONMENT.keys()
    assert made["EDGEVOX_AGENT_NAMESPACE"] == given["EDGEVOX_AGENT_NAMESPACE"]


def test_every_variable_of_the_container_has_a_value_of_the_chart() -> None:
    allowed = set(json.loads(chart.SCHEMA.read_text())["definitions"]["variable"]["enum"])

    assert allowed | set(chart.VARIABLES.values()) | set(chart.FIXED) == ENVIRONMENT.keys()
    assert not allowed & set(chart.VARIABLES.values())


def test_each_value_reaches_the_variable_that_it_is_said_to_reach() -> None:
    speech = {
        "endpoint": "tcp://speech:10300",
        "endpointKeySecret": {"name": "s"},
        "endpointModel": "large",
        "endpointTimeoutSeconds": 4.5,
    }
    values = {
        "agent": "robot-irsim",
        "agentNamespace": "/n",
        "audioIn": "ros2",
        "audioOut": "ros2",
        "discovery": {"range": "LOCALHOST", "server": "dds:11811", "staticPeers": ["peer"]}
        | {"peersWaitSeconds": 3},
        "console": {"enabled": True, "port": 9443, "recordings": {"mb": 77}},
        "drainSeconds": 2.5,
        "framePrefix": "x/",
        "health": {"port": 9000, "host": "::"},
        "language": "fr",
        "llm": {
            "context": 8192,
            "endpoint": "http://llm:8080",
            "endpointGrammar": "vllm",
            "endpointKeySecret": {"name": "s"},
            "endpointModel": "m",
            "endpointTimeoutSeconds": 2.5,
            "model": "none",
            "threads": 3,
        },
        "logLevel": "debug",
        "models": {"offline": False},
        "muted": True,
        "policy": {"rules": {"voice": "deny"}},
        "robotNamespace": "/base",
        "stt": speech,
        "tts": speech | {"endpointVoice": "de=thorsten"},
        "voice": "v",
        "wakeword": "alexa",
    }
    plain, changed = environment(solo()), environment(solo(**values))

    for path, variable in chart.VARIABLES.items():
        wanted: Any = {**values, "domain": 7}
        for part in path.split("."):
            wanted = wanted[part]
        if path.endswith(".endpointKeySecret"):
            wanted = f"/run/secrets/edgevox-{path.partition('.')[0]}/key"
        if path == "policy":
            wanted = "/etc/edgevox/policy/policy.yaml"
        wanted = wanted[0] if isinstance(wanted, list) else wanted
        text = str(wanted).lower() if isinstance(wanted, bool) else str(wanted)
        assert changed[variable] == text, path
        assert variable == "ROS_DOMAIN_ID" or plain.get(variable) != text, path


OLD_NAMES = {"namespace": "EDGEVOX_AGENT_NAMESPACE", "externalNamespace": "EDGEVOX_ROBOT_NAMESPACE"}


@pytest.mark.parametrize(("old", "variable"), OLD_NAMES.items())
def test_a_value_by_its_old_name_goes_on_working_and_is_told_of(old: str, variable: str) -> None:
    values = robot(**{old: "/base"})

    assert environment(pods(values)["solo"])[variable] == "/base"
    assert f"Note: {old} is called " in _notes(values)
    assert "Note:" not in _notes(robot())


def test_the_old_name_of_a_value_for_all_robots_is_less_than_a_robots_own() -> None:
    common = {"externalNamespace": "/common"}

    assert environment(pods(robot() | common)["solo"])["EDGEVOX_ROBOT_NAMESPACE"] == "/common"
    own = robot(robotNamespace="/own") | common
    assert environment(pods(own)["solo"])["EDGEVOX_ROBOT_NAMESPACE"] == "/own"


def _notes(values: dict[str, Any]) -> str:
    rendered = chart.render(values)
    return next(text for name, text in rendered.items() if name.endswith("NOTES.txt"))


def test_numbers_of_settings_are_written_as_they_were_meant() -> None:
    numbers = {"EDGEVOX_SEED": 4294967295, "EDGEVOX_MAX_LINEAR": 0.25, "EDGEVOX_RENDER": False}
    found = environment(solo(settings=numbers))

    assert {name: found[name] for name in numbers} == {
        "EDGEVOX_SEED": "4294967295",
        "EDGEVOX_MAX_LINEAR": "0.25",
        "EDGEVOX_RENDER": "false",
    }


def test_variables_of_ones_own_come_last_with_secrets_by_reference() -> None:
    own = {"name": "TOKEN", "valueFrom": {"secretKeyRef": {"name": "s", "key": "k"}}}
    (container,) = pods(ONE | {"env": [own]})["solo"]["containers"]

    assert container["env"][-1] == own


@settings(max_examples=60, deadline=None)
@given(st.text("/_aB1- ", min_size=1, max_size=8))
def test_chart_and_program_agree_on_namespaces(name: str) -> None:
    assert _refused(robot(agentNamespace=name)) == _refuses({"agent_namespace": name})


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["http://", "https://", "ftp://", ""]),
    st.text("aB1.:/[]@-_ ", min_size=1, max_size=8),
)
def test_chart_and_program_agree_on_endpoints(scheme: str, rest: str) -> None:
    url = scheme + rest
    assert _refused(robot(llm={"endpoint": url})) == _refuses({"llm_endpoint": url})


def _refused(values: dict[str, Any]) -> bool:
    with helm.Chart.load(str(chart.CHART)) as loaded:
        try:
            loaded.validate_schema(values)
        except helm.HelmValuesError:
            return True
    return False


def _refuses(values: dict[str, Any]) -> bool:
    try:
        check_settings(values)
    except InvalidValue:
        return True
    return False


def test_the_page_about_fleets_names_every_setting_of_a_shared_model() -> None:
    page = (chart.CHART.parents[1] / "docs" / "fleet.md").read_text()
    names = [one for one in Settings.model_fields if one.startswith("llm_endpoint")]

    assert [name for name in names if f"`{name}`" not in page] == []
    assert [
        path
        for path, variable in chart.VARIABLES.items()
        if "llm.endpoint" in path
        and f"| `{ENVIRONMENT[variable].setting}` | `{path}` |" not in page
    ] == []
