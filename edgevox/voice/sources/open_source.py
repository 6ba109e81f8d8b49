"""The source that a setting names: WAV files as if somebody spoke them, or no microphone."""

import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import (
    FRAME_S,
    FRAME_SAMPLES,
    RATE_HZ,
    AudioSource,
    EndOfSound,
    Frame,
    Samples,
)
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.sources.soundcard import SoundCard
from edgevox.voice.wav import check_wav, stream_wav

GAP_S = 1.0
"""Silence after each file: what is spoken in it ends there."""


class WavFiles:
    """Plays files one after the other into the listener.

    If `paced`, a frame is ready when the clock reaches its end; else at once. A frame's time is
    always that of its samples, counted from `start`. At the end `read` raises `EndOfSound`.
    """

    def __init__(
        self,
        paths: Sequence[Path],
        *,
        paced: bool = True,
        gap_s: float = GAP_S,
        clock: Clock | None = None,
    ) -> None:
        self.name = ", ".join(path.name for path in paths)
        self._frames = _frames(paths, gap_s)
        self._paced = paced
        self._clock = clock or SystemClock()
        self._closed = threading.Event()
        self._started_s = 0.0
        self._read = 0
        self._next: Samples | None = None

    def start(self) -> None:
        """The first sample sounds now."""
        self._started_s = self._clock.now()

    def read(self, timeout_s: float) -> Frame | None:
        if self._next is None and (self._closed.is_set() or not self._advance()):
            raise EndOfSound(f"{self.name}: all of it was heard")
        end_s = self._started_s + (self._read + 1) * FRAME_S
        if self._paced and not self._reached(end_s, timeout_s):
            return None
        samples, self._next = self._next, None
        self._read += 1
        return None if samples is None else Frame(samples, end_s)

    def close(self) -> None:
        self._closed.set()

    def _advance(self) -> bool:
        self._next = next(self._frames, None)
        return self._next is not None

    def _reached(self, when_s: float, timeout_s: float) -> bool:
        left_s = when_s - self._clock.now()
        if left_s > 0:
            self._closed.wait(min(left_s, timeout_s))
        return when_s <= self._clock.now()


def wav_files(place: Path) -> list[Path]:
    """The file itself, or the WAV files of a folder in the order of their names."""
    if place.is_dir():
        return sorted(p for p in place.iterdir() if p.suffix.lower() == ".wav" and p.is_file())
    return [place]


def _frames(paths: Sequence[Path], gap_s: float) -> Iterator[Samples]:
    silence = np.zeros(int(gap_s * RATE_HZ) // FRAME_SAMPLES * FRAME_SAMPLES, np.int16)
    for path in paths:
        held = np.empty(0, np.int16)
        for block in stream_wav(path):
            held = np.concatenate([held, block])
            whole = held.size // FRAME_SAMPLES * FRAME_SAMPLES
            yield from held[:whole].reshape(-1, FRAME_SAMPLES)
            held = held[whole:]
        rest = np.zeros(-held.size % FRAME_SAMPLES, np.int16)
        yield from np.concatenate([held, rest, silence]).reshape(-1, FRAME_SAMPLES)


class Nothing:
    """Never hears anything; reading only waits."""

    name = "none"

    def __init__(self) -> None:
        self._closed = threading.Event()

    def start(self) -> None: ...

    def read(self, timeout_s: float) -> Frame | None:
        self._closed.wait(timeout_s)
        return None

    def close(self) -> None:
        self._closed.set()


ROS2 = "ros2"
NONE = "none"


def open_source(spec: str, *, paced: bool = True, clock: Clock | None = None) -> AudioSource:
    """The source that `audio_in` names; it captures nothing before its `start`.

    Empty is the default microphone, ``ros2`` a `Pushed` that `edgevox.ros2.audio` fills,
    ``none`` no microphone, a path a WAV file or a folder of them, anything else a microphone's
    name. A path is what exists, ends in ``.wav`` or has a slash. Raises `InvalidValue`.
    """
    if spec == NONE:
        return Nothing()
    if spec == ROS2:
        return Pushed("audio_in", clock)
    place = Path(spec).expanduser()
    if spec and ("/" in spec or place.suffix.lower() == ".wav" or place.exists()):
        return _files(place, paced, clock)
    return SoundCard(spec, clock=clock)


def _files(place: Path, paced: bool, clock: Clock | None) -> WavFiles:
    if not place.exists():
        raise InvalidValue("audio_in", str(place), "a WAV file or a folder of them that exists")
    paths = wav_files(place)
    if not paths:
        raise InvalidValue("audio_in", str(place), "a folder with WAV files in it")
    for path in paths:
        check_wav(path)
    return WavFiles(paths, paced=paced, clock=clock)
