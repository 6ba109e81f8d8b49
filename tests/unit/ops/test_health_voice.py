"""When speech in and out are well: not by what they hear or say, but whether they can."""

import threading

import pytest

from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import EndOfSound
from edgevox.voice.listener import Listener
from edgevox.voice.speech_output import SpeechOutput


class Source:
    """Silent until it is told how to end."""

    name = "test"

    def __init__(self):
        self.end = None
        self.told = threading.Event()

    def start(self): ...

    def read(self, timeout_s):
        self.told.wait(timeout_s)
        if self.end:
            raise self.end
        return

    def close(self):
        self.told.set()


class Vad:
    def reset(self): ...


@pytest.fixture
def source():
    return Source()


@pytest.fixture
def listener(source):
    one = Listener(
        source,
        Vad(),
        None,
        submit=lambda _: None,
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.0,
    )
    yield one
    one.close()


def end(source, error):
    source.end = error
    source.told.set()


def test_a_listener_is_well_before_while_and_after_it_listens(listener):
    assert listener.alive
    listener.start()
    assert listener.alive
    listener.close()
    assert listener.alive


def test_a_listener_that_heard_all_there_is_is_well(listener, source):
    listener.start()
    end(source, EndOfSound("all of it was heard"))
    assert listener.wait_over(60)
    assert listener.alive


def test_a_listener_that_lost_its_source_for_good_is_not(listener, source):
    listener.start()
    end(source, EdgeVoxError("the file is broken"))
    assert listener.wait_over(60)
    for thread in threading.enumerate():
        if thread.name == "edgevox-listener":
            thread.join(60)
    assert not listener.alive


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_speech_output_is_well_until_one_of_its_threads_ends():
    class Broken:
        def prepare(self):
            raise SystemExit

    speech_output = SpeechOutput(Broken(), None)
    assert speech_output.alive
    speech_output.start()
    assert speech_output.alive
    speech_output.prepare()
    for thread in threading.enumerate():
        if thread.name == "edgevox-synthesis":
            thread.join(60)
    assert not speech_output.alive
    speech_output.close()
    assert speech_output.alive
