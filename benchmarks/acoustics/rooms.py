"""Simulated rooms: what a microphone hears of somebody who speaks some way off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acoustics import Half
from edgevox.voice.audio import RATE_HZ

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
        for x, y, z in _images(self):
            length = float(np.linalg.norm(np.subtract((x.at, y.at, z.at), self.microphone_m)))
            index = int((length - first) / _SPEED_OF_SOUND_M_S * RATE_HZ)
            bounces = x.bounces + y.bounces + z.bounces
            if 0 <= index < n:
                found[index] += (1 - absorbed) ** (bounces / 2) / max(length, 0.1)
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


@dataclass(frozen=True, slots=True)
class _Image:
    at: float
    bounces: int


def _images(room: Room) -> "list[tuple[_Image, _Image, _Image]]":
    axes = [
        [
            _Image(2 * k * size + sign * at, abs(2 * k) if sign > 0 else abs(2 * k - 1))
            for k in range(-_EARLY_ORDER, _EARLY_ORDER + 1)
            for sign in (1, -1)
        ]
        for size, at in zip(room.size_m, room.speaker_m, strict=True)
    ]
    return [(x, y, z) for x in axes[0] for y in axes[1] for z in axes[2]]


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
