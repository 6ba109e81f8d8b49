"""Language, voice and muted: parameters and topic commands are one setting, seen from outside."""

import json

import pytest
from guards import HUNG_S
from peer import RELIABLE
from rcl_interfaces.msg import Log, ParameterType, ParameterValue
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParametersAtomically
from std_srvs.srv import Trigger
from waiting import wait_until

NODE = "/edgevox/edgevox"
VOICE = "en_US-joe-medium"


class Settings:
    """The parameter services of the node, as `ros2 param` uses them."""

    def __init__(self, peer):
        self.peer = peer

    def get(self, name):
        request = GetParameters.Request(names=[name])
        (value,) = self.peer.call(GetParameters, f"{NODE}/get_parameters", request).values
        kinds = {ParameterType.PARAMETER_BOOL: value.bool_value}
        return kinds.get(value.type, value.string_value)

    def set(self, **wanted):
        parameters = [ParameterMessage(name=n, value=_value(v)) for n, v in wanted.items()]
        request = SetParametersAtomically.Request(parameters=parameters)
        service = f"{NODE}/set_parameters_atomically"
        return self.peer.call(SetParametersAtomically, service, request).result

    def wait_for(self, name, value):
        wait_until(lambda: self.get(name) == value, f"{name} = {value}")


def _value(value):
    if isinstance(value, bool):
        return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=value)
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)


@pytest.fixture
def settings(robot):
    one = Settings(robot)
    yield one
    assert one.set(language="en", voice="", muted=False).successful


def test_every_parameter_says_what_it_is_and_what_it_may_be(settings):
    names = ["language", "voice", "muted", "confirm", "odom_frame", "frame_prefix"]
    request = DescribeParameters.Request(names=names)
    found = settings.peer.call(
        DescribeParameters, f"{NODE}/describe_parameters", request
    ).descriptors
    assert [one.name for one in found] == names
    assert all(one.description and one.additional_constraints for one in found)
    assert [settings.get(name) for name in names] == ["en", "", False, "unsure", "", ""]


def test_a_topic_command_is_seen_as_a_parameter(settings):
    settings.peer.send("set_language", "fr")
    settings.wait_for("language", "fr")
    settings.peer.send("set_language", "en")
    settings.wait_for("language", "en")
    settings.peer.send("set_voice", VOICE)
    settings.wait_for("voice", VOICE)
    settings.peer.send("command", "mute")
    settings.wait_for("muted", True)
    settings.peer.send("command", "unmute")
    settings.wait_for("muted", False)


def test_a_parameter_takes_effect_and_is_seen_by_queries(settings):
    info = settings.peer.listen("info")
    agent_events = settings.peer.listen("agent_event")
    assert settings.set(language="fr").successful
    settings.peer.send("command", "list_languages")
    assert json.loads(info.wait_for(lambda m: True))["current"] == "fr"
    settings.peer.send("text_input", "arrête")
    assert json.loads(agent_events.wait_for(lambda m: "safety_preempt" in m))["word"] == "arrête"


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [
        ({"language": "xx"}, "language: got 'xx', expected one of en, es"),
        ({"voice": "ff_siwis"}, "voice: got 'ff_siwis', expected for the language en"),
        ({"muted": True, "language": "xx"}, "language: got 'xx'"),
        ({"odom_frame": "odom"}, "read-only"),
    ],
)
def test_a_parameter_that_cannot_be_is_refused_with_the_reason_and_nothing_changes(
    settings, wanted, reason
):
    result = settings.set(**wanted)
    assert not result.successful
    assert reason in result.reason
    assert [settings.get(n) for n in ("language", "voice", "muted")] == ["en", "", False]


def test_a_topic_command_that_cannot_be_is_refused_in_the_log_and_nothing_changes(settings):
    lines = []
    settings.peer.node.create_subscription(Log, "/rosout", lambda m: lines.append(m.msg), RELIABLE)
    wait_until(lambda: settings.peer.node.count_publishers("/rosout") > 1, "the node's log")
    settings.peer.send("set_language", "xx")
    wait_until(lambda: any("language: got 'xx'" in line for line in lines), "the reason")
    assert settings.get("language") == "en"


@pytest.mark.parametrize("query", ["list_voices", "list_languages", "hardware_info", "model_info"])
def test_a_query_is_answered_alike_on_info_and_by_its_service(settings, query):
    info = settings.peer.listen("info")
    settings.peer.send("command", query)
    heard = json.loads(info.wait_for(lambda m: json.loads(m)["query"] == query))
    answer = settings.peer.call(Trigger, f"/edgevox/{query}", Trigger.Request())
    assert answer.success
    assert json.loads(answer.message) == heard


def test_the_answers_are_true(settings):
    def ask(query):
        return json.loads(
            settings.peer.call(Trigger, f"/edgevox/{query}", Trigger.Request()).message
        )

    voices = ask("list_voices")["voices"]
    assert (voices[0], voices[-1]) == (VOICE, "espeak-en")
    assert ask("list_languages")["languages"]["fr"]["name"] == "French"
    with open("/proc/meminfo", encoding="ascii") as info:
        kilobytes = int(info.readline().split()[1])
    assert ask("hardware_info")["ram_gb"] == pytest.approx(kilobytes / 2**20, abs=0.2)
    assert ask("model_info")["llm"] == {"model_path": None, "device": None}


def test_parameters_come_from_the_command_line_and_from_a_file(agent, peer, tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text("/**:\n  ros__parameters:\n    language: it\n    confirm: always\n")
    agent(
        "--ros-args", "-p", "muted:=true", "-p", "frame_prefix:=robot1/",
        "--params-file", str(file), "-r", "__node:=voice", "-r", "__ns:=/robot1",
    )  # fmt: skip
    request = GetParameters.Request(names=["language", "confirm", "muted", "frame_prefix"])
    service = "/robot1/voice/get_parameters"
    values = peer("/robot1").call(GetParameters, service, request).values
    assert [one.string_value for one in values] == ["it", "always", "", "robot1/"]
    assert values[2].bool_value is True


@pytest.mark.parametrize(
    ("argument", "reason"),
    [
        ("language:=xx", "language: got 'xx'"),
        pytest.param("muted:=maybe", "muted", marks=pytest.mark.long),
        pytest.param("language:=3", "language", marks=pytest.mark.long),
    ],
)
def test_a_parameter_that_cannot_be_ends_the_start_with_its_reason(agent, argument, reason):
    one = agent("--ros-args", "-p", argument, wait=False)
    assert one.process.wait(HUNG_S) == 1
    one.terminate()
    assert reason in one.output
    assert "Traceback" not in one.output
