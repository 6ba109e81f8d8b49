"""Sound devices that vanish, and drivers that break: it is said, tried again, and no turn hangs."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest
from guards import HUNG_S
from speech_output_rig import Beeper, Voices, choices, wait_for
from support.clock import HeldClock

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.commands import Heard, Interrupt, TextInput, Transcribing
from edgevox.core.events import Responded
from edgevox.voice import devices
from edgevox.voice.audio import FRAME_SAMPLES
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.listener import Listener
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.sinks.card import SoundCardSink, open_loudspeaker
from edgevox.voice.sources.open_source import SoundCard, open_microphone
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.stt.speech_to_text import Transcript

RATE_HZ = 16_000
ANSWER = "My battery is full and I am well."


class Card:
    """A loudspeaker in simulated time that can be pulled out, with a driver that may complain."""

    name, rate_hz, active = "usb card", RATE_HZ, True

    def __init__(self, clock):
        self.clock, self.plugged, self.played, self.opened = clock, True, 0, 0
        self.on_play = lambda: None
        self.on_close = lambda: None

    @contextmanager
    def open(self, name, fill, opened):
        if not self.plugged:
            raise DeviceMissing(f"no loudspeaker {name!r} on this machine")
        self.opened += 1
        self.active, self._fill = True, fill
        opened(self.rate_hz)
        try:
            yield self
        finally:
            self.on_close()

    def wait(self, token, seconds):
        if self.active and self.opened:
            self.played += int(np.count_nonzero(self._fill(round(seconds * self.rate_hz), 0.02)))
            self.on_play()
        return self.clock.wait(token, seconds)

    def pull(self):
        self.active = self.plugged = False


class Talk:
    """A conversation that speaks on this card; `ask` waits until the turn is over."""

    def __init__(self, card, clock, sink=None):
        self.bus, self.answers, self._answered = Bus(), [], threading.Semaphore(0)
        self.sink = sink or SoundCardSink("usb", opener=card.open, clock=clock, wait=card.wait)
        synthesiser = SentenceSynthesiser(
            lambda: choices("best"), Voices(best=Beeper()), clock=clock
        )
        self.speech_output = SpeechOutput(synthesiser, self.sink, clock=clock)
        self.bus.subscribe(Responded, self._hear)

        @skill(templates=["how are you"], moves=False)
        def how(goal):
            """Say how it is."""
            return {}

        how = SkillSet([how])
        self.conversation = Conversation(
            [Agent("robot", "", how)],
            self.bus,
            halt=lambda _: False,
            speech_output=self.speech_output,
            clock=clock,
        )
        self.speech_output.start()
        self.conversation.start()

    def ask(self):
        self.conversation.submit(TextInput("say something that nobody understands"))
        assert self._answered.acquire(timeout=HUNG_S), "the turn hangs"
        return self.answers[-1]

    def close(self):
        self.conversation.close()
        self.speech_output.close()
        self.sink.close()

    def _hear(self, answer):
        self.answers.append(answer)
        self._answered.release()


@pytest.fixture
def clock():
    return HeldClock(100.0)


@pytest.fixture
def card(clock):
    return Card(clock)


@pytest.fixture
def talk(card, clock):
    talks = []

    def start(**options):
        talks.append(Talk(card, clock, **options))
        return talks[-1]

    yield start
    for one in talks:
        one.close()


def test_a_loudspeaker_that_vanishes_in_a_sentence_ends_no_turn_and_is_used_again(
    talk, card, clock
):
    one = talk()
    card.on_play = lambda: card.pull() if card.played > RATE_HZ / 2 else None
    cut_off = one.ask()
    assert "usb" in one.sink.fault
    assert one.ask().text == cut_off.text  # typed and written, as ever
    card.plugged, card.on_play = True, lambda: None
    clock.wait(CancelToken(), RETRY_S)
    before = card.played
    one.ask()
    assert card.opened == 2
    assert card.played > before + RATE_HZ
    assert one.sink.fault == ""


def test_a_device_that_complains_while_it_is_given_up_is_given_up_all_the_same(talk, card, caplog):
    def complain():
        raise DeviceMissing("PortAudio fails: the host is gone")

    one = talk()
    card.on_close = complain
    card.on_play = card.pull
    one.ask()
    assert "the host is gone" in caplog.text
    one.ask()
    one.sink.close()


class Broken:
    """A loudspeaker whose every call fails, until it is mended."""

    name = "broken"

    def __init__(self, real):
        self.real, self.mended = real, False

    def __getattr__(self, name):
        if not self.mended and name in ("play", "drain", "stop"):
            return self._fail
        return getattr(self.real, name)

    def _fail(self, *_):
        raise RuntimeError("the driver has a bug")


def test_a_driver_that_breaks_leaves_the_voice_alive_and_the_words_written(talk, card, clock):
    sink = Broken(SoundCardSink("usb", opener=card.open, clock=clock, wait=card.wait))
    one = talk(sink=sink)
    assert one.ask().cut
    one.conversation.submit(Interrupt())
    assert one.ask().cut
    assert one.speech_output.alive
    assert one.speech_output.failed >= 2
    sink.mended = True
    assert not one.ask().cut
    assert card.played > RATE_HZ


def test_a_hundred_changes_of_the_voice_load_it_once_before_the_next_sentence(talk):
    one = talk()
    held = threading.Event()
    one.speech_output.synthesiser.prepare = lambda: held.wait(HUNG_S)
    first = one.speech_output.prepare()
    waiting = {id(one.speech_output.prepare()) for _ in range(100)} - {id(first)}
    held.set()
    wait_for(one.speech_output.prepare())
    assert len(waiting) <= 1


class Microphone:
    """Is opened when it is plugged in; hears what the test gives to `hear`."""

    name, active = "usb microphone", True

    def __init__(self):
        self.plugged, self.opened, self.hear = True, threading.Semaphore(0), None

    @contextmanager
    def open(self, name, hear):
        if not self.plugged:
            raise DeviceMissing(f"no microphone {name!r} on this machine")
        self.active, self.hear = True, hear
        self.opened.release()
        yield self

    def pull(self):
        self.active = self.plugged = False


class Vad:
    any_voice = 0.0

    def probability(self, samples):
        return 1.0 if samples[0] >= 8000 else 0.0

    def reset(self): ...


class Stt:
    def transcribe(self, samples, language):
        return Transcript(f"{samples.size} samples")

    def warm_up(self, language): ...

    def close(self): ...


def test_what_was_said_before_a_microphone_vanished_is_understood_and_it_hears_again():
    microphone, said = Microphone(), []
    understood = threading.Semaphore(0)

    def submit(command):
        said.append(command)
        if isinstance(command, Heard):
            understood.release()

    source = SoundCard("usb", opener=microphone.open, retry_s=0.02, silent_s=0.2)
    listener = Listener(
        source, Vad(), Stt(), submit=submit, bus=Bus(), language=lambda: "en",
        muted=lambda: False, audible=lambda: 0.0,
    )  # fmt: skip
    listener.start()
    try:
        for _ in range(2):
            assert microphone.opened.acquire(timeout=HUNG_S)
            for _ in range(40):
                microphone.hear(np.full(FRAME_SAMPLES, 8000, np.int16))
            microphone.pull()  # in the middle of a word
            assert understood.acquire(timeout=HUNG_S), "what was said is lost"
            assert "usb" in source.fault
            assert listener.alive
            microphone.plugged = True
        assert [type(one) for one in said[:2]] == [Transcribing, Heard]
        assert microphone.opened.acquire(timeout=HUNG_S)
        while source.fault:
            threading.Event().wait(0.01)
    finally:
        listener.close()


class PortAudio(SimpleNamespace):
    """Stands in for sounddevice, whose every call may fail."""

    class PortAudioError(Exception): ...

    def __init__(self, failing):
        self.calls = []
        outer = self

        class Stream:
            active = True

            def __init__(self, **_):
                outer.do("open")

            def __enter__(self):
                return self

            def __exit__(self, *_):
                outer.do("close")

            def abort(self):
                outer.calls.append("abort")

        super().__init__(
            failing=failing, calls=self.calls, InputStream=Stream, OutputStream=Stream,
            default=SimpleNamespace(device={"input": 0, "output": 0}),
        )  # fmt: skip

    def do(self, what):
        self.calls.append(what)
        if what == self.failing:
            raise self.PortAudioError(f"{what}: unanticipated host error")

    def _terminate(self):
        self.do("terminate")

    def _initialize(self):
        self.do("initialize")

    def check_input_settings(self, *_, **__):
        self.do("check")

    def query_devices(self):
        self.do("query")
        both = {"max_input_channels": 1, "max_output_channels": 2}
        return [{"index": 0, "name": "usb", "default_samplerate": 48_000.0, **both}]


ABSENT = """
import looked_for
looked_for.begun.set()
looked_for.by_all.wait({hung_s})
raise OSError("PortAudio library not found")
"""


def test_a_machine_without_portaudio_says_so_to_all_that_look_for_it_at_once(tmp_path, monkeypatch):
    (tmp_path / "sounddevice.py").write_text(ABSENT.format(hung_s=HUNG_S))
    looked_for = SimpleNamespace(begun=threading.Event(), by_all=threading.Event())
    others = threading.Barrier(8, looked_for.by_all.set)
    monkeypatch.setitem(sys.modules, "looked_for", looked_for)
    monkeypatch.delitem(sys.modules, "sounddevice", raising=False)
    monkeypatch.syspath_prepend(tmp_path)

    def look(*, first=False):
        if not first:
            assert looked_for.begun.wait(HUNG_S)
            others.wait(HUNG_S)
        with pytest.raises(DeviceMissing, match="libportaudio2"):
            devices.devices("input")

    with ThreadPoolExecutor(9) as pool:
        looks = [pool.submit(look, first=not number) for number in range(9)]
        for one in looks:
            one.result()


OPENERS = [
    lambda: open_microphone("usb", lambda _: None),
    lambda: open_loudspeaker("usb", lambda count, _: np.zeros(count, np.int16), lambda _: None),
]


@pytest.mark.parametrize("opener", OPENERS, ids=["microphone", "loudspeaker"])
@pytest.mark.parametrize("failing", ["terminate", "initialize", "query", "open", "close"])
def test_whatever_portaudio_complains_of_is_a_device_that_is_missing(monkeypatch, opener, failing):
    portaudio = PortAudio(failing)
    monkeypatch.setitem(sys.modules, "sounddevice", portaudio)
    with pytest.raises(DeviceMissing, match="unanticipated host error"), opener():
        pass
    portaudio.failing = ""
    devices.look_again()  # which it does only while no stream counts as used
    assert portaudio.calls[-2:] == ["terminate", "initialize"]


@pytest.mark.parametrize("opener", OPENERS, ids=["microphone", "loudspeaker"])
def test_a_device_is_given_up_without_waiting_for_it(monkeypatch, opener):
    portaudio = PortAudio("")
    monkeypatch.setitem(sys.modules, "sounddevice", portaudio)
    with opener():
        pass
    assert portaudio.calls[-2:] == ["abort", "close"]
