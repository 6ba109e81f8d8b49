"""The loudspeakers' promises, in simulated time and without a sound card."""

import logging
import os
import signal
import subprocess
import sys
import wave
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from speech_output_rig import RATE_HZ, Recorder, beep
from support.clock import HeldClock

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import Chunk
from edgevox.voice.devices import DeviceMissing
from edgevox.voice.sinks import PacedSink, open_sink
from edgevox.voice.sinks.card import SoundCardSink
from edgevox.voice.sinks.open_sink import WavFile
from edgevox.voice.sinks.paced import Silence

QUIET = CancelToken()


@pytest.fixture
def clock() -> HeldClock:
    return HeldClock(100.0)


def read(path: Path) -> tuple[int, np.ndarray]:
    with wave.open(str(path)) as file:
        data = file.readframes(file.getnframes())
        return file.getframerate(), np.frombuffer(data, np.int16)


def test_playing_blocks_until_little_is_left_and_draining_until_nothing_is(clock: HeldClock):
    sink = PacedSink(Silence(), clock=clock, wait=clock.wait)
    began_s = clock.now()
    assert sink.play(Chunk(beep(1.0), RATE_HZ), QUIET) == began_s
    assert clock.now() - began_s == pytest.approx(0.9)
    assert sink.play(Chunk(beep(0.5), RATE_HZ), QUIET) == pytest.approx(began_s + 1.0)
    sink.drain(QUIET)
    assert clock.now() - began_s == pytest.approx(1.5)


def test_a_stopped_sink_tells_what_was_not_played_and_plays_no_more_of_it(clock: HeldClock):
    output, token = Recorder(), CancelToken()
    sink = PacedSink(output, clock=clock, wait=clock.wait)
    clock.at(clock.now() + 0.3, token.cancel)
    sink.play(Chunk(beep(2.0), RATE_HZ), token)
    stopped_s = clock.now()
    assert sink.stop() == pytest.approx(1.7, abs=0.02)
    assert output.end_s - stopped_s <= 0.1
    assert sink.play(Chunk(beep(0.1), RATE_HZ), QUIET) == stopped_s


def test_a_sink_that_is_stopped_by_another_thread_does_not_block_who_plays(clock: HeldClock):
    sink = PacedSink(Recorder(), clock=clock, wait=clock.wait)
    began_s = clock.now()
    clock.at(began_s + 0.3, sink.stop)
    sink.play(Chunk(beep(5.0), RATE_HZ), QUIET)
    assert clock.now() - began_s < 0.4


def test_a_sink_knows_how_loud_it_is_at_this_moment(clock: HeldClock):
    sink = PacedSink(Silence(), clock=clock, wait=clock.wait)
    heard = []
    for when_s in (0.25, 0.75):
        clock.at(clock.now() + when_s, lambda: heard.append(sink.audible()))
    loud = Chunk(np.concatenate([beep(0.5), np.zeros(RATE_HZ // 2, np.int16)]), RATE_HZ)
    sink.play(loud, QUIET)
    sink.drain(QUIET)
    assert heard == [pytest.approx(8000 / 32768, rel=1e-3), 0.0]
    assert sink.audible() == 0.0


def test_every_rate_takes_its_own_time(clock: HeldClock):
    output = Recorder()
    sink = PacedSink(output, clock=clock, wait=clock.wait)
    for rate_hz in (22_050, 24_000, 16_000):
        sink.play(Chunk(np.full(rate_hz, 5000, np.int16), rate_hz), QUIET)
    sink.drain(QUIET)
    assert output.seconds == pytest.approx(3.0, abs=0.01)


def test_a_paced_file_is_what_a_person_in_the_room_would_have_heard(
    clock: HeldClock, tmp_path: Path
):
    path = tmp_path / "out.wav"
    sink = PacedSink(WavFile(path, clock), clock=clock, wait=clock.wait)
    clock.wait(QUIET, 2.0)
    sink.play(Chunk(np.full(24_000, 8000, np.int16), 24_000), QUIET)
    sink.drain(QUIET)
    clock.wait(QUIET, 3.0)
    token = CancelToken()
    clock.at(clock.now() + 0.5, token.cancel)
    sink.play(Chunk(np.full(48_000, 8000, np.int16), 24_000), token)
    sink.stop()
    sink.close()
    rate_hz, sound = read(path)
    loud = np.flatnonzero(sound) / rate_hz
    assert loud[0] == pytest.approx(2.0, abs=0.01)
    assert len(sound) / rate_hz == pytest.approx(6.5, abs=0.05)
    assert not sound[int(3.05 * rate_hz) : int(5.95 * rate_hz)].any()


KILLED = """
import os, signal, sys
import numpy as np
from pathlib import Path
from edgevox.voice.sinks.open_sink import WavFile
WavFile(Path(sys.argv[1])).write(np.full(24000, 8000, np.int16), 0.0)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_file_of_a_killed_process_is_whole_up_to_then(tmp_path: Path):
    path = tmp_path / "out.wav"
    ended = subprocess.run([sys.executable, "-c", KILLED, str(path)], timeout=60, env=os.environ)
    assert ended.returncode == -signal.SIGKILL
    assert len(read(path)[1]) == 24_000


@dataclass
class FakeCard:
    """A sound card in simulated time: it plays when somebody waits."""

    clock: HeldClock
    name: str = "card"
    rate_hz: int = 48_000
    active: bool = True
    plugged: bool = True
    opened: int = 0
    played: int = 0

    @contextmanager
    def open(
        self, name: str, fill: Callable[[int, float], np.ndarray], opened: Callable[[int], None]
    ) -> Iterator["FakeCard"]:
        if not self.plugged:
            raise DeviceMissing(f"no loudspeaker {name!r} on this machine")
        self.opened += 1
        self.active = True
        self._fill = fill
        opened(self.rate_hz)
        yield self

    def wait(self, token: CancelToken, seconds: float) -> bool:
        if self.active and self.opened:
            block = self._fill(round(seconds * self.rate_hz), 0.02)
            self.played += int(np.count_nonzero(block))
        return self.clock.wait(token, seconds)


@pytest.fixture
def card(clock: HeldClock) -> FakeCard:
    return FakeCard(clock)


def sink_on(card: FakeCard) -> SoundCardSink:
    return SoundCardSink("usb", opener=card.open, clock=card.clock, wait=card.wait)


def test_a_card_plays_all_of_it_at_its_own_rate(card: FakeCard):
    sink = sink_on(card)
    sink.play(Chunk(beep(1.0), RATE_HZ), QUIET)
    sink.drain(QUIET)
    assert card.played / card.rate_hz == pytest.approx(1.0, abs=0.01)
    sink.close()


def test_a_stopped_card_is_given_nothing_more(card: FakeCard):
    sink, token = sink_on(card), CancelToken()
    card.clock.at(card.clock.now() + 0.3, token.cancel)
    sink.play(Chunk(beep(2.0), RATE_HZ), token)
    left_s = sink.stop()
    before = card.played
    card.wait(QUIET, 0.1)
    assert card.played == before
    assert left_s + before / card.rate_hz == pytest.approx(2.0, abs=0.01)


def test_a_missing_card_is_said_once_and_speech_takes_its_time(
    card: FakeCard, caplog: pytest.LogCaptureFixture
):
    card.plugged = False
    sink = sink_on(card)
    began_s = card.clock.now()
    for _ in range(10):
        sink.play(Chunk(beep(1.0), RATE_HZ), QUIET)
    sink.drain(QUIET)
    assert card.clock.now() - began_s == pytest.approx(10.0)
    warnings = [one for one in caplog.records if one.levelno == logging.WARNING]
    assert [one.getMessage() for one in warnings] == [
        "loudspeaker_missing reason=\"no loudspeaker 'usb' on this machine\" retry_s=3.0"
    ]


def test_a_card_that_is_plugged_in_later_is_used(card: FakeCard):
    card.plugged = False
    sink = sink_on(card)
    sink.play(Chunk(beep(4.0), RATE_HZ), QUIET)
    card.plugged = True
    sink.play(Chunk(beep(1.0), RATE_HZ), QUIET)
    sink.drain(QUIET)
    assert card.played / card.rate_hz == pytest.approx(1.0, abs=0.01)


def test_a_card_that_is_pulled_out_is_said_and_nobody_hangs(
    card: FakeCard, caplog: pytest.LogCaptureFixture
):
    sink = sink_on(card)

    def pull() -> None:
        card.active = card.plugged = False

    card.clock.at(card.clock.now() + 0.5, pull)
    sink.play(Chunk(beep(5.0), RATE_HZ), QUIET)
    sink.play(Chunk(beep(1.0), RATE_HZ), QUIET)
    sink.drain(QUIET)
    assert "card plays no more" in caplog.text
    sink.close()


@pytest.mark.parametrize(
    ("spec", "reason"),
    [
        ("ros2", "only together with --ros2"),
        ("/no/such/folder/out.wav", "can be written"),
        ("some/where", "ends in .wav"),
    ],
)
def test_a_place_that_cannot_be_spoken_to_is_refused_by_its_setting(spec: str, reason: str):
    with pytest.raises(InvalidValue, match=reason) as refused:
        open_sink(spec)
    assert refused.value.field == "audio_out"


def test_the_setting_chooses_the_sink(tmp_path: Path):
    path = tmp_path / "a.wav"
    for spec, kind in (("none", PacedSink), (str(path), PacedSink), ("ros2", PacedSink)):
        sink = open_sink(spec, relay=Recorder())
        assert isinstance(sink, kind)
        sink.close()
