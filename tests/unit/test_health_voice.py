"""When ears and a mouth are well: not by what they hear or say, but whether they can."""

import threading

import pytest

from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import EndOfSound
from edgevox.voice.ears import Ears
from edgevox.voice.mouth import SpeakingMouth


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
def ears(source):
    one = Ears(
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


def test_ears_are_well_before_while_and_after_they_listen(ears):
    assert ears.alive
    ears.start()
    assert ears.alive
    ears.close()
    assert ears.alive


def test_ears_that_heard_all_there_is_are_well(ears, source):
    ears.start()
    end(source, EndOfSound("all of it was heard"))
    assert ears.wait_over(10)
    assert ears.alive


def test_ears_that_lost_their_source_for_good_are_not(ears, source):
    ears.start()
    end(source, EdgeVoxError("the file is broken"))
    assert ears.wait_over(10)
    for thread in threading.enumerate():
        if thread.name == "edgevox-ears":
            thread.join(60)
    assert not ears.alive


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_mouth_is_well_until_one_of_its_threads_ends():
    class Broken:
        def prepare(self):
            raise SystemExit

    mouth = SpeakingMouth(Broken(), None)
    assert mouth.alive
    mouth.start()
    assert mouth.alive
    mouth.prepare()
    for thread in threading.enumerate():
        if thread.name == "edgevox-synthesis":
            thread.join(60)
    assert not mouth.alive
    mouth.close()
    assert mouth.alive
