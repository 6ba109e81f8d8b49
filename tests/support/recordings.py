"""Recordings that tests and benchmarks make."""

import wave
from pathlib import Path

import numpy as np

from edgevox.voice.audio import RATE_HZ, Samples


def write_wav(path: Path, *pieces: Samples, rate_hz: int = RATE_HZ) -> Path:
    """Write one piece after the other, mono and 16 bit; the path."""
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate_hz)
        file.writeframes(np.concatenate(pieces).astype("<i2").tobytes())
    return path
