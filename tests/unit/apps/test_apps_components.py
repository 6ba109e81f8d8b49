"""The components that an agent lists, with their values fetched from its parts."""

import sys
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.remote_model import FallbackModel
from edgevox.apps.agent.build import build_parts, list_components
from edgevox.apps.folders import places_folder, written_folders
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.servers.errors import Unreachable
from edgevox.core.settings import check_settings
from edgevox.core.status import Gauges, Level
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.ros2.contract import DIAGNOSTICS
from edgevox.ros2.open import NullBridge

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts"))

from docs.components import COMPONENTS

EXAMPLE = Path(__file__).parents[3] / "examples" / "ros2" / "diagnostics.yaml"


@pytest.fixture
def listed():
    with ExitStack() as stack:

        def build(body=None):
            settings = check_settings({"text_mode": True, "llm": "none"})
            parts = build_parts(stack, settings, body)
            list_components(parts, Gauges(parts.bus))
            return parts.components

        yield build


def test_every_agent_lists_the_same_components_and_what_is_off_is_well(listed):
    report = listed().statuses()
    assert [one.name for one in report] == [row.name for row in COMPONENTS]
    off = {one.name: one.level for one in report if one.message.startswith("off")}
    parts = "audio stt llm tts sim executor presence console recordings recorder"
    assert off == dict.fromkeys(parts.split(), Level.OK)
    assert all(row.name in DIAGNOSTICS.about for row in COMPONENTS)


def test_a_group_needs_ros_2():
    silent = {"audio_in": "none", "audio_out": "none", "llm": "none"}
    with ExitStack() as stack, pytest.raises(InvalidValue, match="--ros2") as refused:
        build_parts(stack, check_settings(silent | {"answer_group": "hall"}), None)
    assert refused.value.field == "answer_group"


def test_a_body_tells_its_kind_pace_and_battery(listed):
    body = ApartmentRobot(speed=0.0)
    sim = {one.name: one for one in listed(body).statuses()}["sim"]
    assert (sim.level, sim.message) == (Level.OK, "runs")
    assert sim.values["body"] == "robot-apartment"
    assert sim.texts["battery"] == "1"


def test_a_bridge_that_is_not_on_ros2_is_an_error(listed):
    components = listed()
    components.add(*NullBridge().components)
    executor = {one.name: one for one in components.statuses()}["executor"]
    assert executor.level is Level.ERROR
    assert "rclpy" in executor.message


def test_what_is_written_to_follows_the_environment():
    settings = check_settings({"audio_out": "said.wav"})
    environment = {"EDGEVOX_MODELS_DIR": "/models", "ROS_LOG_DIR": "/logs", "HOME": "/home/me"}

    folders = written_folders(settings, environment)

    assert {Path("/models"), Path("/logs"), Path.cwd()} <= set(folders)
    assert Path("/home/me/.local/state/edgevox") in folders
    assert places_folder(settings, {"XDG_STATE_HOME": "/state"}) == Path("/state/edgevox")
    assert places_folder(check_settings({"places": "/places"})) == Path("/places")


class Server:
    name, context_tokens = "server", 100

    def __init__(self):
        self.down = True

    def generate(self, messages, *, grammar, max_tokens, token):
        if self.down:
            raise Unreachable("nobody answers")
        yield "yes"

    def count_tokens(self, text):
        return len(text)


def test_a_shared_model_tells_its_trouble_until_it_answers_again():
    class Never:
        resting = False

        def failed(self):
            return True

        def succeeded(self):
            return True

    server = Server()
    model = FallbackModel(server, None, Never())
    ask = {"grammar": None, "max_tokens": 1, "token": CancelToken()}
    with pytest.raises(ModelFailed):
        list(model.generate([], **ask))
    assert model.fault == "nobody answers"
    server.down = False
    assert list(model.generate([], **ask)) == ["yes"]
    assert model.fault == ""


def test_the_example_for_the_aggregator_finds_the_names_that_are_published():
    analyzers = yaml.safe_load(EXAMPLE.read_text())["analyzers"]["ros__parameters"]
    groups = {key: one for key, one in analyzers.items() if isinstance(one, dict)}
    assert len(groups) == 2
    for robot, group in groups.items():
        (prefix,) = group["find_and_remove_prefix"]
        assert f"/{robot}/edgevox: audio".startswith(prefix)
