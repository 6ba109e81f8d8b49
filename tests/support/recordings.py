"""Recordings that tests and benchmarks make, play and take."""

import threading
import wave
from pathlib import Path

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.voice.audio import (
    FRAME_S,
    FRAME_SAMPLES,
    RATE_HZ,
    Chunk,
    EndOfSound,
    Frame,
    Samples,
)
from edgevox.voice.sinks.open_sink import WavFile
from edgevox.voice.sinks.paced import RateChanger


def write_wav(path: Path, *pieces: Samples, rate_hz: int = RATE_HZ) -> Path:
    """Write one piece after the other, mono and 16 bit; the path."""
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate_hz)
        file.writeframes(np.concatenate(pieces).astype("<i2").tobytes())
    return path


class InMemory:
    """Plays samples at 16 kHz as fast as they are read, `times` over, then raises `EndOfSound`.

    A frame's time is that of its samples, counted from `start`. An incomplete frame at the end is
    left out.
    """

    name = "memory"

    def __init__(self, samples: Samples, *, times: int = 1, clock: Clock | None = None) -> None:
        count = samples.size // FRAME_SAMPLES
        self._frames = samples[: count * FRAME_SAMPLES].reshape(count, FRAME_SAMPLES)
        self._total = count * times
        self._clock = clock or SystemClock()
        self._started_s = 0.0
        self._read = 0

    @property
    def heard_s(self) -> float:
        """Seconds of sound that were read so far."""
        return self._read * FRAME_S

    def start(self) -> None:
        self._started_s = self._clock.now()

    def read(self, timeout_s: float) -> Frame | None:
        if self._read >= self._total:
            raise EndOfSound(f"{self.name}: all of it was heard")
        samples = self._frames[self._read % len(self._frames)]
        self._read += 1
        return Frame(samples, self._started_s + self.heard_s)

    def close(self) -> None:
        self._total = self._read


class UnpacedWav:
    """A sink that writes at once, one sound after the other, for tests that do not want to wait."""

    name = "file"

    def __init__(self, file: WavFile, clock: Clock | None = None) -> None:
        self._file = file
        self._clock = clock or SystemClock()
        self._lock = threading.Lock()
        self._rate = RateChanger(file.rate_hz)

    @property
    def fault(self) -> str:
        """The reason why nothing goes into the file at the moment; empty otherwise."""
        return self._file.fault

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        with self._lock:
            if not token.cancelled:
                self._file.write(self._rate.push(chunk), 0.0)
        return self._clock.now()

    def drain(self, token: CancelToken) -> None:
        with self._lock:
            self._file.write(self._rate.flush(), 0.0)

    def stop(self) -> float:
        """All that was given is in the file."""
        return 0.0

    def audible(self) -> float:
        return 0.0

    def close(self) -> None:
        with self._lock:
            self._file.close()
