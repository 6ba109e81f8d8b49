"""The played sound of the last few seconds, by the time at which it is heard.

A sink adds its real output, after every change of rate and volume; an echo canceller asks for the
sound that played while a frame was captured. Neither waits for the other.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np

from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.wav import Resampler

JOINED_S = 0.03
"""A piece that begins so near to the end of the last one follows on it: the clocks of a card and of
this machine are not the same, and callbacks come late."""
KEPT_S = 4.0
"""More than may wait between a microphone and its listener."""
MOST_PIECES = 2048


@dataclass(frozen=True, slots=True)
class _Piece:
    samples: Samples
    rate_hz: int
    start_s: float


@dataclass(frozen=True, slots=True)
class _Cut:
    at_s: float


class PlayedSound:
    """One thread or more adds, one other asks. Where nothing was played there is silence."""

    def __init__(self) -> None:
        self._new: deque[_Piece | _Cut] = deque(maxlen=MOST_PIECES)
        self._kept = np.zeros(0, np.int16)
        self._end = 0  # the position, in samples of the clock's time, after the last one kept
        self._resampler: Resampler | None = None
        self._rate_hz = 0
        self._joins_s: float | None = None

    def add(self, samples: Samples, rate_hz: int, start_s: float) -> None:
        """Sound that is heard from the clock's time `start_s` on."""
        self._new.append(_Piece(samples, rate_hz, start_s))

    def cut(self, at_s: float) -> None:
        """Remove the sound that was added for this time and later: it is not played after all."""
        self._new.append(_Cut(at_s))

    def between(self, start: int, count: int) -> Samples:
        """`count` samples at 16 kHz, from this position of the clock's time (in samples) on."""
        self._take_in()
        out = np.zeros(count, np.int16)
        first = self._end - self._kept.size
        low, high = max(start, first), min(start + count, self._end)
        if low < high:
            out[low - start : high - start] = self._kept[low - first : high - first]
        return out

    def _take_in(self) -> None:
        while self._new:
            match self._new.popleft():
                case _Piece() as piece:
                    self._place(piece)
                case _Cut(at_s=at_s):
                    self._shorten(round(at_s * RATE_HZ))
        self._kept = self._kept[-round(KEPT_S * RATE_HZ) :]

    def _place(self, piece: _Piece) -> None:
        joins = self._joins_s is not None and abs(piece.start_s - self._joins_s) < JOINED_S
        if self._resampler is None or not joins or piece.rate_hz != self._rate_hz:
            self._begin(round(piece.start_s * RATE_HZ))
            self._joins_s = piece.start_s
            self._rate_hz = piece.rate_hz
            self._resampler = Resampler(piece.rate_hz, RATE_HZ)
        self._append(self._resampler.push(piece.samples))
        self._joins_s = (self._joins_s or 0.0) + piece.samples.size / piece.rate_hz

    def _begin(self, position: int) -> None:
        """Let the next samples begin at this position; before it there is silence."""
        gap = position - self._end
        if gap > KEPT_S * RATE_HZ:
            self._kept = np.zeros(0, np.int16)
            self._end = position
        elif gap > 0:
            self._append(np.zeros(gap, np.int16))
        else:
            self._shorten(position)

    def _append(self, samples: Samples) -> None:
        self._kept = np.concatenate([self._kept, samples])
        self._end += samples.size

    def _shorten(self, position: int) -> None:
        first = self._end - self._kept.size
        if position < self._end:
            self._kept = self._kept[: max(0, position - first)]
            self._end = first + self._kept.size
        self._joins_s = None
