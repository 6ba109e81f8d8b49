"""Simulated rooms: what a microphone hears of somebody who speaks some way off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ
from training.acoustics import Half

_SPEED_OF_SOUND_M_S = 343.0
_EARLY_ORDER = 2
_ROOMS = {Half.TRAIN: 11, Half.TUNING: 1_201, Half.HELD_OUT: 4_711}
_ROOMS_BY_RT60 = {Half.TRAIN: 19, Half.TUNING: 97, Half.HELD_OUT: 523}


@dataclass(frozen=True, slots=True)
class Room:
    """A box of `size_m`, reverberant for `rt60_s`, with a speaker and a microphone in it."""

    size_m: tuple[float, float, float]
    rt60_s: float
    speaker_m: tuple[float, float, float]
    microphone_m: tuple[float, float, float]
    seed: int

    @property
    def distance_m(self) -> float:
        return float(np.linalg.norm(np.subtract(self.speaker_m, self.microphone_m)))

    def response(self) -> NDArray[np.float64]:
        """Its impulse response, from the direct sound on, at an energy of 1.

        Early reflections are images of the speaker in the walls; what comes later is noise that
        dies away.
        """
        n = int(min(self.rt60_s, 0.8) * RATE_HZ)
        found, first = np.zeros(n), self.distance_m
        volume, absorbed = np.prod(self.size_m), self._absorption()
        at, bounces = _images(self)
        lengths = np.linalg.norm(at - self.microphone_m, axis=1)
        late = ((lengths - first) / _SPEED_OF_SOUND_M_S * RATE_HZ).astype(int)
        heard = (late >= 0) & (late < n)
        strengths = (1 - absorbed) ** (bounces / 2) / np.maximum(lengths, 0.1)
        np.add.at(found, late[heard], strengths[heard])
        t = np.arange(n) / RATE_HZ
        tail = np.random.default_rng(self.seed).normal(0, 1, n) * 10 ** (-3 * t / self.rt60_s)
        critical_m = 0.057 * np.sqrt(volume / self.rt60_s)
        tail[: int(0.012 * RATE_HZ)] *= 0.1
        tail *= 1 / critical_m / np.sqrt(np.sum(tail**2))
        found += tail
        return found / np.sqrt(np.sum(found**2))

    def _absorption(self) -> float:
        """Of the walls, by Sabine."""
        a, b, c = self.size_m
        return min(0.95, 0.161 * a * b * c / (2 * (a * b + b * c + a * c) * self.rt60_s))


def _images(room: Room) -> tuple[NDArray[np.float64], NDArray[np.int_]]:
    """Where the speaker is seen in the walls, shape (n, 3), and after how many bounces, (n,)."""
    orders = np.repeat(np.arange(-_EARLY_ORDER, _EARLY_ORDER + 1), 2)
    signs = np.tile((1, -1), orders.size // 2)
    bounces = np.where(signs > 0, abs(2 * orders), abs(2 * orders - 1))
    axes = [
        2 * orders * size + signs * at for size, at in zip(room.size_m, room.speaker_m, strict=True)
    ]
    images = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return images, sum(np.meshgrid(bounces, bounces, bounces, indexing="ij")).reshape(-1)


def rooms(half: Half, number: int = 40) -> list[Room]:
    """So many rooms; those of another part have other sizes, other places and other seeds."""
    rng = np.random.default_rng(_ROOMS[half])
    return [_room(rng, seed) for seed in range(number)]


def room_of(rt60_s: float, half: Half, seed: int = 0) -> Room:
    """One with this reverberation, in which somebody speaks from 1 to 3 m off."""
    rng = np.random.default_rng((_ROOMS_BY_RT60[half], seed))
    return _room(rng, seed, rt60_s)


def in_room(sound: NDArray[np.generic], response: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same as heard in the room, as long as it was plus the response."""
    n = sound.size + response.size - 1
    size = 1 << (n - 1).bit_length()
    return np.fft.irfft(np.fft.rfft(sound, size) * np.fft.rfft(response, size), size)[:n]


def _room(rng: np.random.Generator, seed: int, rt60_s: float | None = None) -> Room:
    size = (rng.uniform(2.5, 9), rng.uniform(2.5, 7), rng.uniform(2.2, 3.5))
    microphone = tuple(float(rng.uniform(0.2, 0.8) * side) for side in size)
    while True:
        speaker = tuple(float(rng.uniform(0.1, 0.9) * side) for side in size)
        if 0.5 <= np.linalg.norm(np.subtract(speaker, microphone)) <= 3.0:
            break
    reverberation_s = rt60_s or float(rng.uniform(0.2, 0.7))
    whole = int(rng.integers(1 << 30)) + seed
    return Room(size, reverberation_s, speaker, microphone, whole)  # type: ignore[arg-type]
