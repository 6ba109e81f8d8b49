"""A microphone that somebody else holds, and a loudspeaker that others hear along."""

import threading

import numpy as np
import pytest
from speech_output_rig import RATE_HZ, Recorder, beep
from support.clock import HeldClock
from voice_script import VOICE, WAKE, Stt, Vad, Wake
from waiting import Heard as HeardMessages

from edgevox.apps.console.build_context import SharedSound
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.commands import Heard, Interrupt
from edgevox.core.events import SentenceReady
from edgevox.voice.audio import FRAME_SAMPLES, Chunk, UtteranceOver
from edgevox.voice.listener import Listener
from edgevox.voice.sinks import PacedSink
from edgevox.voice.sinks.paced import Silence, Tap, TappedSink
from edgevox.voice.sources.pushed import Pushed

QUIET = CancelToken()
SAID, SILENT = [VOICE] * 20, [0] * 40


@pytest.fixture(autouse=True)
def patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here a minute is pushed within a moment; the listener may take its time."""
    monkeypatch.setattr("edgevox.voice.sources.pushed.MAX_FRAMES", 10_000)


class Ears:
    """A listener behind a microphone that is pushed into, frame by frame."""

    def __init__(self, *texts: str, wakeword: Wake | None = None, playing: float = 0.0) -> None:
        self.clock = HeldClock(100.0)
        self.source = Pushed("page", self.clock)
        self.said: HeardMessages[object] = HeardMessages()
        self.stt = Stt(*texts)
        self.listener = Listener(
            self.source,
            Vad(),
            self.stt,
            submit=self.said.add,
            bus=Bus(),
            language=lambda: "en",
            muted=lambda: False,
            audible=lambda: playing,
            wakeword=wakeword,
            is_stop=lambda text: "stop" in text,
            echo="off",
            clock=self.clock,
        )

    def __enter__(self) -> "Ears":
        self.listener.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.listener.close()

    def push(self, levels: list[int], *, addressed: bool = False) -> None:
        for level in levels:
            self.clock.now_s += FRAME_SAMPLES / 16_000
            self.source.push(np.full(FRAME_SAMPLES, level, np.int16), addressed=addressed)

    def words(self) -> list[str]:
        return [one.text for one in self.said.messages if isinstance(one, Heard)]

    def next_words(self) -> str:
        return self.said.wait_for(lambda one: isinstance(one, Heard)).text


def test_who_holds_the_button_needs_no_wake_word() -> None:
    with Ears("go left", wakeword=Wake()) as ears:
        ears.push(SAID + SILENT, addressed=True)
        assert ears.next_words() == "go left"


def test_without_the_button_only_a_stop_word_counts() -> None:
    with Ears("go left", "please stop", wakeword=Wake()) as ears:
        ears.push(SAID + SILENT)
        ears.push(SAID + SILENT)
        assert ears.next_words() == "please stop"
        assert ears.words() == ["please stop"]


def test_the_wake_word_counts_without_the_button() -> None:
    with Ears("go left", wakeword=Wake()) as ears:
        ears.push([WAKE, *SAID, *SILENT])
        assert ears.next_words() == "go left"


def test_letting_go_ends_what_is_said_without_a_silence() -> None:
    with Ears("go left") as ears:
        ears.push(SAID, addressed=True)
        ears.source.end()
        assert ears.next_words() == "go left"


def test_of_who_is_gone_nothing_counts() -> None:
    with Ears("go right") as ears:
        ears.push(SAID, addressed=True)
        ears.source.abandon()
        ears.push(SAID, addressed=True)
        ears.source.end()
        assert ears.next_words() == "go right"
        assert len(ears.stt.heard) == 1


def test_the_button_counts_for_what_was_begun_with_it_only() -> None:
    with Ears("go left", "go right", "stop", wakeword=Wake()) as ears:
        ears.push(SAID, addressed=True)
        ears.source.end()
        ears.push(SAID + SILENT)
        ears.push(SAID + SILENT)
        ears.said.wait_for(lambda one: isinstance(one, Heard) and one.text == "stop")
        assert ears.words() == ["go left", "stop"]


def test_who_speaks_into_the_button_over_the_robot_interrupts_it() -> None:
    with Ears("go left", wakeword=Wake(), playing=0.1) as ears:
        ears.push(SAID, addressed=True)
        told = ears.said.wait_for(lambda one: isinstance(one, Interrupt))
        assert told.motion is False


def test_a_source_tells_its_end_after_what_was_pushed_and_forgets_what_was_abandoned() -> None:
    source = Pushed("page", HeldClock(1.0))
    source.push(np.zeros(FRAME_SAMPLES, np.int16))
    source.end()
    assert source.read(0.0) is not None
    with pytest.raises(UtteranceOver) as over:
        source.read(0.0)
    assert not over.value.abandoned
    source.push(np.zeros(FRAME_SAMPLES, np.int16))
    source.abandon()
    with pytest.raises(UtteranceOver) as over:
        source.read(0.0)
    assert over.value.abandoned
    assert source.read(0.0) is None


class Listens:
    def __init__(self) -> None:
        self.samples: list[np.ndarray] = []
        self.cuts = 0

    def cut(self) -> None:
        self.cuts += 1

    @property
    def seconds(self) -> float:
        return sum(map(len, self.samples)) / 16_000


def test_who_hears_along_hears_all_of_it_and_the_loudspeaker_plays_as_before() -> None:
    clock, output, along = HeldClock(100.0), Recorder(), Listens()
    sink = TappedSink(PacedSink(output, clock=clock, wait=clock.wait))
    sink.tap(Tap(along.samples.append, along.cut))
    assert sink.play(Chunk(beep(1.0), RATE_HZ), QUIET) == 100.0
    sink.drain(QUIET)
    assert clock.now() == pytest.approx(101.0)
    assert output.seconds == pytest.approx(1.0)
    assert along.seconds == pytest.approx(1.0, abs=0.01)
    assert along.cuts == 0


def test_who_hears_along_is_told_that_it_was_cut_and_forgotten_hears_nothing() -> None:
    clock, along = HeldClock(100.0), Listens()
    sink = TappedSink(PacedSink(Silence(), clock=clock, wait=clock.wait))
    forget = sink.tap(Tap(along.samples.append, along.cut))
    sink.stop()
    assert along.cuts == 1
    forget()
    sink.play(Chunk(beep(0.5), RATE_HZ), QUIET)
    sink.stop()
    assert along.seconds == 0.0
    assert along.cuts == 1


@pytest.fixture
def shared() -> SharedSound:
    clock = HeldClock(1.0)
    sink = TappedSink(PacedSink(Silence(), clock=clock, wait=clock.wait))
    return SharedSound(Pushed("page", clock), sink, Bus())


def test_one_speaks_at_a_time(shared: SharedSound) -> None:
    assert shared.open("a", held=True)
    assert not shared.open("b", held=True)
    shared.close("b")
    assert not shared.open("b", held=True)
    shared.abandon("a")
    assert shared.open("b", held=True)


def test_only_who_speaks_is_heard_and_only_held_is_it_addressed() -> None:
    source, bus = Pushed("page", HeldClock(1.0)), Bus()
    shared = SharedSound(source, TappedSink(PacedSink(Silence())), bus)
    frame = np.ones(FRAME_SAMPLES, np.int16)
    shared.open("a", held=False)
    shared.push("b", frame)
    assert source.read(0.0) is None
    shared.push("a", frame)
    assert not source.read(1.0).addressed
    shared.open("a", held=True)
    shared.push("a", frame)
    assert source.read(1.0).addressed
    shared.open("a", held=False)
    with pytest.raises(UtteranceOver):
        source.read(1.0)


def test_speech_carries_the_turn_it_belongs_to() -> None:
    clock, bus, heard = HeldClock(1.0), Bus(), threading.Event()
    sink = TappedSink(PacedSink(Silence(), clock=clock, wait=clock.wait))
    shared = SharedSound(Pushed("page", clock), sink, bus)
    turns: list[tuple[int, int]] = []
    shared.listen(lambda turn, pcm: turns.append((turn, len(pcm))), heard.set)
    bus.publish(SentenceReady("Going.", 4))
    sink.play(Chunk(np.zeros(1600, np.int16), 16_000), QUIET)
    sink.stop()
    assert turns == [(4, 3200)]
    assert heard.is_set()
