"""Files that people name are regular and bounded; what else is named is refused, by its field."""

import os
import sys
from pathlib import Path

import pytest

from edgevox.agent.llm import weights
from edgevox.agent.llm.language_model import ModelFailed
from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import Unusable
from edgevox.core.settings import load_settings
from edgevox.robots.humanoid.environment import read_robot
from edgevox.robots.world.load import load_world
from edgevox.ros2.external.settings import load_locations
from edgevox.scenario import load_scenario
from edgevox.voice.sinks.open_sink import WavFile
from edgevox.voice.sources.open_source import open_source

HANG_S = 60
AGENT = Path(sys.executable).with_name("edgevox-agent")
READERS = {
    "world": load_world,
    "scenario": load_scenario,
    "locations": load_locations,
    "config": lambda file: load_settings({}, file),
    "mjcf": read_robot,
}
OTHERS = {
    "audio_in": (lambda file: open_source(str(file)), InvalidValue),
    "audio_out": (WavFile, InvalidValue),
    "llm": (weights.check, ModelFailed),
    "llm_endpoint_key_file": (lambda file: Address("http://x", key_file=file).headers(), Unusable),
}


@pytest.fixture(params=["pipe", "device", "folder"])
def no_file(request, tmp_path):
    """Something with a file's name: a pipe that nobody writes to, a device without an end, ..."""
    place = tmp_path / "thing.wav"
    match request.param:
        case "pipe":
            os.mkfifo(place)
        case "device":
            place.symlink_to("/dev/zero")
        case "folder":
            place.mkdir()
    return place


@pytest.mark.parametrize("field", READERS)
def test_what_is_no_regular_file_is_refused_by_field_and_expectation(field, no_file):
    with pytest.raises(InvalidValue, match="Not a regular file|Is a directory") as refused:
        READERS[field](no_file)
    assert refused.value.field == field


@pytest.mark.parametrize("field", OTHERS)
def test_nor_is_it_sound_a_model_or_a_key(field, no_file):
    use, error = OTHERS[field]
    with pytest.raises(error, match=no_file.name):
        use(no_file)


@pytest.mark.parametrize("field", READERS)
def test_a_gigabyte_is_refused_unread(field, tmp_path):
    large = tmp_path / "large"
    with large.open("wb") as stream:
        stream.truncate(1 << 30)
    with pytest.raises(InvalidValue, match=r"at most \d+ bytes") as refused:
        READERS[field](large)
    assert refused.value.field == field


def test_a_key_as_long_as_a_book_is_no_key(tmp_path):
    file = tmp_path / "key"
    file.write_text("x" * 1_000_000, encoding="ascii")
    with pytest.raises(Unusable, match="does not hold one key"):
        Address("http://x", key_file=file).headers()


def test_a_file_without_a_size_is_read_up_to_the_bound():
    assert "Name:" in read_text(Path("/proc/self/status"), "world")


def test_a_link_to_a_file_is_that_file(tmp_path):
    (tmp_path / "there").write_text("x" * LARGEST_TEXT_BYTES, encoding="utf-8")
    (tmp_path / "here").symlink_to("there")
    assert len(read_text(tmp_path / "here", "world")) == LARGEST_TEXT_BYTES
