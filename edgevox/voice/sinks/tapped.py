"""A sink that lets other listeners hear what plays on the chosen sink."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.status import fault_of
from edgevox.voice.audio import RATE_HZ, AudioSink, Chunk, Samples
from edgevox.voice.sinks.paced import RateChanger


@dataclass(frozen=True, slots=True)
class Tap:
    """A listener to the played sound.

    Its calls come on the thread that speaks and must not block.
    """

    hear: Callable[[Samples], None]
    """Takes samples at 16 kHz, up to 0.2 s before they are due."""
    cut: Callable[[], None]
    """Called when the sound was cut."""


class TappedSink:
    """Plays on `sink`, as if it were alone. Without listeners, taps cost nothing."""

    def __init__(self, sink: AudioSink) -> None:
        self.name = sink.name
        self._sink = sink
        self._rate = RateChanger(RATE_HZ)
        self._lock = threading.Lock()
        self._taps: tuple[Tap, ...] = ()

    @property
    def fault(self) -> str:
        """The reason why the chosen sink's sound goes nowhere; empty otherwise."""
        return fault_of(self._sink)

    def tap(self, tap: Tap) -> Callable[[], None]:
        """Let it hear from now on; returns a way to forget it."""
        with self._lock:
            self._taps = (*self._taps, tap)
        return lambda: self._forget(tap)

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        if not token.cancelled:
            self._tell(chunk)
        return self._sink.play(chunk, token)

    def drain(self, token: CancelToken) -> None:
        self._tell(None)
        self._sink.drain(token)

    def stop(self) -> float:
        left_s = self._sink.stop()
        with self._lock:
            taps = self._taps
            self._rate.flush()
        for tap in taps:
            tap.cut()
        return left_s

    def audible(self) -> float:
        return self._sink.audible()

    def close(self) -> None:
        self._sink.close()

    def _tell(self, chunk: Chunk | None) -> None:
        """Give the taps this chunk; None for the end of the utterance."""
        with self._lock:
            taps = self._taps
            if not taps:
                self._rate.flush()
                return
            samples = self._rate.push(chunk) if chunk else self._rate.flush()
        if samples.size:
            samples = np.ascontiguousarray(samples)
            for tap in taps:
                tap.hear(samples)

    def _forget(self, tap: Tap) -> None:
        with self._lock:
            self._taps = tuple(one for one in self._taps if one is not tap)
