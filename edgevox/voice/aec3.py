"""WebRTC's echo canceller AEC3, from the package `pywebrtc-audio`, for frames of ours."""

from typing import Protocol

import numpy as np

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples

BLOCK_SAMPLES = 160
"""It works on 10 ms."""
DELAY_SAMPLES = 128
"""What frames may leave of a block at most; so much later comes all that it gives back."""


class CancellingEngine(Protocol):
    """An echo canceller for samples at 16 kHz."""

    def process(self, near: Samples, far: Samples) -> Samples:
        """What was heard, without what was played; whole blocks."""


def open_engine() -> CancellingEngine:
    """AEC3. Raises `ImportError` where the package is not installed."""
    import pywebrtc_audio

    engine: CancellingEngine = pywebrtc_audio.EchoCanceller(RATE_HZ)
    return engine


class FrameCanceller:
    """Gives frames to an engine in its own blocks, and back in ours."""

    def __init__(self, engine: CancellingEngine) -> None:
        self._engine = engine
        self.begin_after(np.zeros(FRAME_SAMPLES, np.int16))

    def begin_after(self, samples: Samples) -> None:
        """The next frame follows on these samples, which it was not given."""
        self._near = self._far = np.zeros(0, np.int16)
        self._out = samples[-DELAY_SAMPLES:]

    def push(self, near: Samples, far: Samples) -> Samples:
        """A frame without what was played, 8 ms late."""
        self._near = np.concatenate([self._near, near])
        self._far = np.concatenate([self._far, far])
        whole = self._near.size // BLOCK_SAMPLES * BLOCK_SAMPLES
        cleaned = self._engine.process(self._near[:whole], self._far[:whole])
        self._near, self._far = self._near[whole:], self._far[whole:]
        out = np.concatenate([self._out, cleaned])
        self._out = out[FRAME_SAMPLES:]
        return out[:FRAME_SAMPLES]
