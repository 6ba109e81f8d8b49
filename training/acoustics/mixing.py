"""Speech and noise together, at a signal to noise ratio that is the one of the voice."""

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples

_STEP = RATE_HZ // 50
_VOICED_DB = -25.0


def voiced_power(sound: NDArray[np.generic]) -> float:
    """The mean power of those 20 ms pieces that are at most 25 dB below the loudest one."""
    power, voiced = _pieces(sound)
    return float(np.mean(power[voiced]))


def voiced_part(sound: Samples) -> Samples:
    """From the first to the last of those pieces."""
    voiced = np.flatnonzero(_pieces(sound)[1])
    return sound[voiced[0] * _STEP : (voiced[-1] + 1) * _STEP]


def _pieces(sound: NDArray[np.generic]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The power of each 20 ms, and whether there is a voice."""
    whole = np.asarray(sound, np.float64)
    pieces = whole[: whole.size // _STEP * _STEP].reshape(-1, _STEP)
    power = np.mean(pieces**2, axis=1) if len(pieces) else np.zeros(1)
    return power, power >= power.max() * 10 ** (_VOICED_DB / 10)


def mixed(
    speech: NDArray[np.generic], noise: NDArray[np.float64], snr_db: float
) -> NDArray[np.float64]:
    """Both, as long as the speech; the noise so many dB softer than the voiced part of it."""
    wide = np.asarray(speech, np.float64)
    noise_power = max(1e-12, float(np.mean(noise[: wide.size] ** 2)))
    gain = np.sqrt(voiced_power(wide) / noise_power / 10 ** (snr_db / 10))
    return wide + gain * np.resize(noise, wide.size)


def at_level(sound: NDArray[np.generic], level_db: float) -> Samples:
    """As 16 bit samples, its voiced part at so many dB below full scale (negative); clipped."""
    wide = np.asarray(sound, np.float64)
    gain = 32768 * 10 ** (level_db / 20) / max(1e-9, np.sqrt(voiced_power(wide)))
    return np.clip(wide * gain, -32768, 32767).astype(np.int16)
