"""What the stop word spotter looks at: how strong 40 bands are beside what they were just before.

Mel bands of 25 ms every 8 ms, each divided by its own slow average and then compressed (per-channel
energy normalisation, PCEN): a hum that goes on vanishes, and how loud one speaks hardly matters.
"""

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples

Floats = NDArray[np.float32]

BANDS = 40
WINDOW_SAMPLES, HOP_SAMPLES, _FFT = 400, 128, 512
ROWS = FRAME_SAMPLES // HOP_SAMPLES
"""Rows of features that a frame of sound brings."""
_LOWEST_HZ, _HIGHEST_HZ = 60.0, 7600.0
_SPEED = 0.02  # of the slow average: it follows within 0.4 s
_POWER, _OFFSET, _ROOT = 0.98, 2.0, 0.5
_FLOOR = 1e4  # of a band's energy: about that of a silent room's hiss


class StopFeatures:
    """Features of a stream of sound, a frame at a time; the same as those of all of it at once."""

    def __init__(self) -> None:
        self._sound = np.zeros(WINDOW_SAMPLES - HOP_SAMPLES + FRAME_SAMPLES, np.float32)
        self._slow: Floats | None = None

    def push(self, samples: Samples) -> Floats:
        """The rows that end in these `FRAME_SAMPLES` samples, shape (`ROWS`, `BANDS`)."""
        self._sound[:-FRAME_SAMPLES] = self._sound[FRAME_SAMPLES:]
        self._sound[-FRAME_SAMPLES:] = samples
        energy = _energy(self._sound)
        slow = _averages(energy, self._slow)
        self._slow = slow[-1]
        return _compressed(energy, slow)

    def forget(self) -> None:
        """The next frame does not follow on those before."""
        self._sound[:] = 0
        self._slow = None


def _bands() -> Floats:
    """Triangular filters, shape (bins, `BANDS`)."""
    lowest, highest = (2595 * np.log10(1 + end / 700) for end in (_LOWEST_HZ, _HIGHEST_HZ))
    corners = 700 * (10 ** (np.linspace(lowest, highest, BANDS + 2) / 2595) - 1)
    hertz = np.arange(_FFT // 2 + 1)[:, np.newaxis] * RATE_HZ / _FFT
    low, middle, high = corners[:-2], corners[1:-1], corners[2:]
    rising, falling = (hertz - low) / (middle - low), (high - hertz) / (high - middle)
    return np.asarray(np.maximum(0, np.minimum(rising, falling)), np.float32)


_FILTERS = _bands()
_TAPER = np.hanning(WINDOW_SAMPLES + 1)[:-1].astype(np.float32)


def _energy(sound: Floats) -> Floats:
    """Of the bands in every window of the sound."""
    windows = np.lib.stride_tricks.sliding_window_view(sound, WINDOW_SAMPLES)[::HOP_SAMPLES]
    spectrum = np.fft.rfft(windows * _TAPER, _FFT)
    power = spectrum.real**2 + spectrum.imag**2
    return np.asarray(power.astype(np.float32) @ _FILTERS)


def _averages(energy: Floats, past: Floats | None) -> Floats:
    """The slow average at every row; the first one begins with the first window that is full."""
    known = energy[ROWS - 1] if past is None else past
    found = np.empty_like(energy)
    for number, row in enumerate(energy):
        known = known + _SPEED * (row - known)
        found[number] = known
    return found


def _compressed(energy: Floats, slow: Floats) -> Floats:
    beside = energy / (_FLOOR + slow) ** np.float32(_POWER)
    return np.asarray((beside + _OFFSET) ** _ROOT - _OFFSET**_ROOT, np.float32)


def features_of(sound: Samples) -> Floats:
    """Of whole frames of sound at once, as `StopFeatures` finds them, shape (rows, `BANDS`)."""
    before = np.zeros(WINDOW_SAMPLES - HOP_SAMPLES, np.float32)
    energy = _energy(np.concatenate([before, sound[: sound.size // FRAME_SAMPLES * FRAME_SAMPLES]]))
    return _compressed(energy, _averages(energy, None))
