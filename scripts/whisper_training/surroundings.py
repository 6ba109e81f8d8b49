"""What a microphone hears of something that is said: in a room, by a microphone, in noise."""

from collections.abc import Sequence

import numpy as np
from acoustics import Half
from acoustics.mixing import voiced_power
from acoustics.rooms import rooms
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples

Wave = NDArray[np.float32]

ROOMS = 60
LEVEL_DB = (-42, -12)
"""How loud the voice is, of full scale."""
FASTER = (0.85, 1.18)
QUIET_DB = (-90, -60)
"""How loud noise is of full scale where it is quiet."""


def varied(samples: Samples, rng: np.random.Generator) -> Wave:
    """Faster or slower, as a whole: pitch goes with it; and at a loudness of 1."""
    step = rng.uniform(*FASTER)
    n = int(samples.size / step)
    changed = np.interp(np.arange(n) * step, np.arange(samples.size), samples)
    return (changed / np.sqrt(voiced_power(changed) + 1e-9)).astype(np.float32)


class Surroundings:
    """Puts what is said into one of these noises, and a share of it into a room to train with.

    In a share of it it is quiet; else the voice is so many dB above the noise.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        noises: Sequence[Wave],
        room_share: float,
        quiet_share: float,
        snr_db: tuple[float, float],
    ) -> None:
        self._rng = rng
        self._noises = noises
        self._room_share, self._quiet_share, self._snr_db = room_share, quiet_share, snr_db
        self._rooms = [room.response().astype(np.float32) for room in rooms(Half.TRAIN, ROOMS)]

    def heard(self, track: Wave) -> Samples:
        """What the microphone hears of it, as long as it is."""
        rng = self._rng
        level = 10 ** (rng.uniform(*LEVEL_DB) / 20)
        speech = self._elsewhere(track)
        speech *= level / np.sqrt(voiced_power(speech) + 1e-9) if np.any(track) else 0
        if rng.random() < self._quiet_share:
            rustle = 10 ** (rng.uniform(*QUIET_DB) / 20)
        else:
            rustle = level / 10 ** (rng.uniform(*self._snr_db) / 20)
        heard = speech + rustle * self._noise(track.size)
        if rng.random() < 0.15:
            heard = heard + rustle * rng.uniform(0.3, 1) * self._noise(track.size)
        return np.clip(32768 * heard, -32768, 32767).astype(np.int16)

    def _elsewhere(self, track: Wave) -> Wave:
        """In a room, or not, by a microphone of some colour."""
        rng = self._rng
        response = self._response() if rng.random() < self._room_share else np.ones(1, np.float32)
        size = 1 << (track.size + response.size).bit_length()
        spectrum = np.fft.rfft(track, size) * np.fft.rfft(response, size) * self._colour(size)
        return np.fft.irfft(spectrum, size)[: track.size]

    def _response(self) -> Wave:
        """That of a room, of which now and then only the beginning is left."""
        rng = self._rng
        response = self._rooms[rng.integers(len(self._rooms))]
        if rng.random() < 0.3:
            soon = np.arange(response.size, dtype=np.float32) / np.float32(rng.uniform(400, 3000))
            response = response * np.exp(-soon)
            response /= np.sqrt(np.sum(response**2))
        return response

    def _colour(self, size: int) -> Wave:
        """A tilt and a hump, as microphones and mouths differ."""
        rng = self._rng
        octaves = np.log2(np.maximum(np.fft.rfftfreq(513 * 2, 1 / RATE_HZ), 60) / 1000)
        hump = rng.uniform(-6, 6) * np.exp(-(((octaves - rng.uniform(-2, 3)) / 0.7) ** 2))
        coarse = 10 ** ((rng.uniform(-3, 3) * octaves + hump) / 20)
        fine = np.linspace(0, coarse.size - 1, size // 2 + 1)
        return np.interp(fine, np.arange(coarse.size), coarse).astype(np.float32)

    def _noise(self, n: int) -> Wave:
        """Some of it, from somewhere, now and then with a change of loudness."""
        rng = self._rng
        whole = self._noises[rng.integers(len(self._noises))]
        start = rng.integers(whole.size - n)
        some = whole[start : start + n]
        if rng.random() < 0.3:
            some = some * np.interp(
                np.arange(n), np.linspace(0, n, 5), 10 ** (rng.uniform(-10, 4, 5) / 20)
            )
        return some[::-1] if rng.random() < 0.3 else some
