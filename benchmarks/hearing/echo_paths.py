"""What a microphone hears of a loudspeaker, simulated: small, distorting, in a room, late, by a
clock of its own.

Everything is drawn from a seed, so two ways of listening hear the same.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples

Sound = NDArray[np.float64]
"""Mono sound at 16 kHz, shape (n,); full scale is 1."""

FULL_SCALE = 32768.0
_SMALLEST_HZ = 250.0
"""What a loudspeaker of a few centimetres plays no more below."""
_FIRST_WALL_S = 0.003
"""A metre: until the first reflection comes."""
_FINE = 4


@dataclass(frozen=True, slots=True)
class EchoPath:
    """From the samples that are played to those that the microphone gives, `gain_db` louder.

    `drift_ppm` is by how much the loudspeaker's clock runs faster than the microphone's, `drive`
    how hard the loudspeaker is pushed into its limits (0: not at all), `jitter_s` by how much the
    frames of the microphone may come late, each differently.
    """

    delay_s: float
    drift_ppm: float
    reverberation_s: float
    direct_db: float
    drive: float
    gain_db: float = -6.0
    jitter_s: float = 0.0
    seed: int = 0

    def gain(self, played: Sound) -> float:
        """What makes the echo of this as loud as it is to be."""
        way = level(self._way(played))
        return level(played) * 10 ** (self.gain_db / 20) / way if way else 0.0

    def echo(self, played: Sound, gain: float | None = None) -> Sound:
        """What comes back, as long as what was played."""
        return self._way(played) * (self.gain(played) if gain is None else gain)

    def _way(self, played: Sound) -> Sound:
        heard = _drifted(_loudspeaker(played, self.drive), self.drift_ppm)
        late = np.concatenate([np.zeros(round(self.delay_s * RATE_HZ)), heard])[: played.size]
        return _convolved(late, response(self.reverberation_s, self.direct_db, self.seed))

    def name(self) -> str:
        return (
            f"{1000 * self.delay_s:.0f} ms, {self.drift_ppm:+.0f} ppm, "
            f"RT60 {self.reverberation_s:.2f} s, drive {self.drive:.0f}"
        )


PATHS = (
    EchoPath(0.020, 0.0, 0.15, 9.0, 0.0, seed=1),
    EchoPath(0.060, 20.0, 0.30, 6.0, 2.0, seed=2),
    EchoPath(0.100, -50.0, 0.40, 6.0, 2.0, jitter_s=0.010, seed=3),
    EchoPath(0.150, 100.0, 0.40, 3.0, 4.0, jitter_s=0.010, seed=4),
    EchoPath(0.200, -100.0, 0.50, 3.0, 2.0, jitter_s=0.030, seed=5),
    EchoPath(0.250, 100.0, 0.60, 0.0, 4.0, jitter_s=0.030, seed=6),
)
"""From a loudspeaker beside the microphone of one card to one of another computer."""


def level(sound: Sound) -> float:
    """Root mean square of where it is not silent: over the frames of 32 ms above -50 dB."""
    frames = sound[: sound.size // 512 * 512].reshape(-1, 512)
    powers = np.mean(frames**2, axis=1)
    loud = powers[powers > 1e-5]
    return float(np.sqrt(loud.mean())) if loud.size else 0.0


def at_level(sound: Sound, wanted: float) -> Sound:
    """The same, so loud."""
    found = level(sound)
    return sound * (wanted / found) if found else sound


def response(reverberation_s: float, direct_db: float, seed: int) -> Sound:
    """A room's impulse response: the direct sound, and noise that decays by 60 dB in that time.

    `direct_db` is by how much the direct sound is stronger than all of the room's.
    """
    rng = np.random.default_rng(seed)
    count = round(reverberation_s * RATE_HZ)
    tail = rng.normal(0, 1, count) * np.exp(-6.9 * np.arange(count) / count)
    tail[: round(_FIRST_WALL_S * RATE_HZ)] = 0.0
    tail /= np.sqrt(np.sum(tail**2))
    tail[0] = 10 ** (direct_db / 20)
    return tail / np.sqrt(np.sum(tail**2))


def noise_floor(count: int, seed: int, amplitude: float = 0.001) -> Sound:
    """-60 dB: the microphone's and the room's."""
    return np.random.default_rng(1000 + seed).normal(0, amplitude, count)


def as_samples(sound: Sound) -> Samples:
    """As a sound card gives it: 16 bit, clipped."""
    return np.clip(np.rint(sound * FULL_SCALE), -32768, 32767).astype(np.int16)


def _loudspeaker(sound: Sound, drive: float) -> Sound:
    """No bass, and limits that are softer on one side than on the other."""
    spectrum = np.fft.rfft(sound)
    hertz = np.fft.rfftfreq(sound.size, 1 / RATE_HZ)
    small = np.fft.irfft(spectrum * hertz**2 / (hertz**2 + _SMALLEST_HZ**2), sound.size)
    if not drive:
        return small
    return (np.tanh(drive * small + 0.1) - np.tanh(0.1)) / drive


def _drifted(sound: Sound, ppm: float) -> Sound:
    """The same, by a clock that runs faster by so much."""
    if not ppm:
        return sound
    spectrum = np.fft.rfft(sound)
    fine = np.fft.irfft(spectrum, sound.size * _FINE) * _FINE
    at = np.arange(sound.size) * (1 + ppm * 1e-6) * _FINE
    return np.interp(at, np.arange(fine.size), fine, right=0.0)


def _convolved(sound: Sound, by: Sound) -> Sound:
    size = 1 << (sound.size + by.size - 1).bit_length()
    product = np.fft.rfft(sound, size) * np.fft.rfft(by, size)
    return np.fft.irfft(product, size)[: sound.size]
