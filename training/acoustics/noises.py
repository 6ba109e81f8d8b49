"""What else is heard: noises, made from a seed, each at a root mean square of 1."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ
from training.acoustics import Half
from training.acoustics.sentences import sentences
from training.acoustics.voices import espeak_voices, say

Wave = NDArray[np.float64]
_SEEDS = 1_000_000
_FIRST_SEED = {Half.TRAIN: 0, Half.HELD_OUT: _SEEDS, Half.TUNING: 2 * _SEEDS}
_TALK = (
    "I have left the other box in the hall, so bring it along when you come back.",
    "We were at the market in the morning and bought apples, bread and a little cheese.",
    "Could you tell me again when the next train is going to leave from here?",
    "She said that nobody had seen the new machine before it was put to work.",
    "It takes about an hour by car, but on a Sunday it may well be less than that.",
    "The children are playing outside and will not be back before the evening.",
)


def white(rng: np.random.Generator, n: int) -> Wave:
    """Hiss."""
    return rng.normal(0, 1, n)


def coloured(rng: np.random.Generator, n: int, slope: float) -> Wave:
    """Noise whose power falls with frequency to the power `slope`: 1 pink, 2 brown."""
    spectrum = np.fft.rfft(rng.normal(0, 1, n))
    hertz = np.maximum(np.fft.rfftfreq(n, 1 / RATE_HZ), 30.0)
    return np.fft.irfft(spectrum * hertz ** (-slope / 2), n)


def pink(rng: np.random.Generator, n: int) -> Wave:
    """A quiet street, wind, a room with people far away."""
    return coloured(rng, n, 1.0)


def brown(rng: np.random.Generator, n: int) -> Wave:
    """Rumble."""
    return coloured(rng, n, 2.0)


def motor(rng: np.random.Generator, n: int) -> Wave:
    """A motor under changing load: a hum with many harmonics, and brushes."""
    base = rng.uniform(40, 220) * (1 + 0.15 * _slow(rng, n))
    return _harmonics(rng, base, 24) + 0.3 * rng.uniform(0.3, 1.5) * pink(rng, n)


def gears(rng: np.random.Generator, n: int) -> Wave:
    """A gearbox: high harmonics that go up and down with a rattle, as a servo's."""
    base = rng.uniform(250, 700) * (1 + 0.3 * _slow(rng, n, 2.0))
    rattle = 1 + 0.6 * np.sin(2 * np.pi * np.cumsum(base / 13) / RATE_HZ)
    return _harmonics(rng, base, 10) * rattle + 0.4 * white(rng, n)


def fan(rng: np.random.Generator, n: int) -> Wave:
    """Air, with the tone of its blades."""
    blades = np.sin(2 * np.pi * rng.uniform(60, 250) * np.arange(n) / RATE_HZ)
    return coloured(rng, n, rng.uniform(0.6, 1.4)) * (1 + 0.1 * blades) + 0.3 * blades


def vacuum(rng: np.random.Generator, n: int) -> Wave:
    """A vacuum cleaner: strong hiss around 1 to 4 kHz over a whine."""
    spectrum = np.fft.rfft(rng.normal(0, 1, n))
    hertz = np.fft.rfftfreq(n, 1 / RATE_HZ)
    middle = rng.uniform(1000, 3000)
    shaped = np.fft.irfft(spectrum / (1 + ((hertz - middle) / middle) ** 2), n)
    return _level(shaped) + 0.4 * _level(_harmonics(rng, np.full(n, rng.uniform(300, 600)), 8))


def clatter(rng: np.random.Generator, n: int) -> Wave:
    """Dishes and tools: short, ringing knocks over a soft floor of noise."""
    made = 0.03 * pink(rng, n)
    for at in rng.integers(0, n, max(1, int(n / RATE_HZ * rng.uniform(1.5, 4)))):
        length = min(n - at, int(RATE_HZ * rng.uniform(0.03, 0.25)))
        t = np.arange(length) / RATE_HZ
        ring = sum(np.sin(2 * np.pi * rng.uniform(400, 6000) * t) for _ in range(4))
        made[at : at + length] += ring * np.exp(-t * rng.uniform(15, 90)) * rng.uniform(0.2, 1)
    return made


def beeps(rng: np.random.Generator, n: int) -> Wave:
    """Machines that beep and play tunes: tones of some length, and now and then none."""
    made, at = 0.02 * pink(rng, n), 0
    while at < n:
        length = min(n - at, int(RATE_HZ * rng.uniform(0.05, 0.6)))
        hertz = rng.uniform(150, 2500) * np.ones(length)
        if rng.random() < 0.3:
            hertz *= np.linspace(1, rng.uniform(0.5, 2), length)
        if rng.random() < 0.75:
            made[at : at + length] += _harmonics(rng, hertz, int(rng.integers(2, 8)))
        at += length
    return made


def pump(rng: np.random.Generator, n: int) -> Wave:
    """A pump: strokes of hiss and rumble, one to five a second."""
    stroke = np.sin(np.pi * rng.uniform(1, 5) * np.cumsum(1 + 0.1 * _slow(rng, n)) / RATE_HZ) ** 6
    return stroke * (pink(rng, n) + 0.3 * white(rng, n)) + 0.2 * brown(rng, n)


def wheels(rng: np.random.Generator, n: int) -> Wave:
    """Drive motors that start, cruise and brake: gears, the drive's whistle, tyres on the floor."""
    speed, turns = _driven(rng, n), rng.uniform(60, 180)
    gears = _harmonics(rng, turns * speed, 20)
    mesh = _harmonics(rng, rng.integers(7, 19) * turns * speed, 5)
    whistle = np.sin(2 * np.pi * rng.uniform(3000, 7000) * np.arange(n) / RATE_HZ)
    rolling = 0.8 * _level(coloured(rng, n, 1.5))
    return (0.5 * gears + 0.5 * mesh + 0.1 * whistle + rolling) * (0.02 + speed**0.7)


def joints(rng: np.random.Generator, n: int) -> Wave:
    """The servos of an arm or a leg: short moves, each a whine that rises and falls."""
    made, at = 0.01 * white(rng, n), 0
    while at < n:
        length = min(n - at, int(RATE_HZ * rng.uniform(0.12, 0.9)))
        speed = np.sin(np.pi * np.linspace(0, 1, length)) ** rng.uniform(0.3, 1.2)
        base = rng.uniform(120, 600) * (0.25 + speed)
        whine = _harmonics(rng, base, int(rng.integers(4, 16)))
        whine *= 1 + 0.3 * np.sin(2 * np.pi * np.cumsum(base / 11) / RATE_HZ)
        made[at : at + length] += (whine + 0.3 * white(rng, length)) * speed
        at += length + int(RATE_HZ * rng.uniform(0, 0.6))
    return made


def steps(rng: np.random.Generator, n: int) -> Wave:
    """A humanoid that walks: each step a thump, a slap and a ringing shell, over its joints."""
    made, at, period_s = 0.4 * joints(rng, n), 0.0, rng.uniform(0.35, 0.8)
    while at < n:
        first = int(at)
        t = np.arange(min(n - first, RATE_HZ // 4)) / RATE_HZ
        thump = 6 * np.sin(2 * np.pi * rng.uniform(50, 110) * t) * np.exp(-25 * t)
        slap = 3 * white(rng, t.size) * np.exp(-rng.uniform(60, 200) * t)
        shell = sum(
            np.sin(2 * np.pi * rng.uniform(200, 1800) * t) * np.exp(-rng.uniform(20, 60) * t)
            for _ in range(4)
        )
        made[first : first + t.size] += rng.uniform(0.7, 1) * (thump + slap + shell)
        at += RATE_HZ * period_s * rng.uniform(0.93, 1.07)
    return made


def fans(rng: np.random.Generator, n: int) -> Wave:
    """Fans whose speed follows the load."""
    speed = 0.65 + 0.35 * _slow(rng, n, 0.25)
    blades = _harmonics(rng, rng.uniform(150, 450) * speed, 6)
    return (_level(coloured(rng, n, rng.uniform(0.5, 1.4))) + 0.5 * blades) * speed


def babble(rng: np.random.Generator, n: int, half: Half, people: int = 5) -> Wave:
    """Several people who talk at once, none of whom says a stop word."""
    voices, made = espeak_voices(half), np.zeros(n)
    talk = _TALK if half is Half.HELD_OUT else sentences(half)
    for _ in range(people):
        track: list[Wave] = []
        while sum(part.size for part in track) < 2 * n:
            voice = voices[rng.integers(len(voices))]
            track.append(_level(say(voice, talk[rng.integers(len(talk))]).astype(np.float64)))
        whole = np.concatenate(track)
        start = rng.integers(0, whole.size - n)
        made += whole[start : start + n] * rng.uniform(0.5, 1)
    return made


_Maker = Callable[[np.random.Generator, int], Wave]
_BOTH: dict[str, _Maker] = {"white": white, "pink": pink, "motor": motor, "fan": fan}
_ONLY: dict[Half, dict[str, _Maker]] = {
    Half.TRAIN: {"brown": brown, "beeps": beeps},
    Half.TUNING: {"pump": pump},
    Half.HELD_OUT: {"gears": gears, "vacuum": vacuum, "clatter": clatter},
}
_ITS_OWN: dict[str, _Maker] = {"wheels": wheels, "joints": joints, "steps": steps, "fans": fans}
ITS_OWN = tuple(_ITS_OWN)
"""What a robot hears of itself: in no half, because nothing is trained with it."""
BABBLE = "babble"


def kinds(half: Half) -> tuple[str, ...]:
    """The names of this half's noises; gears, vacuum and clatter are never trained with."""
    return (*_BOTH, *_ONLY[half], BABBLE)


def noise(kind: str, seconds: float, seed: int, half: Half) -> Wave:
    """So much of a noise, at a root mean square of 1; no seed of one half is one of another."""
    rng = np.random.default_rng(seed % _SEEDS + _FIRST_SEED[half])
    n = int(seconds * RATE_HZ)
    if kind == BABBLE:
        return _level(babble(rng, n, half))
    return _level(({**_BOTH, **_ONLY[half], **_ITS_OWN})[kind](rng, n))


def _level(sound: Wave) -> Wave:
    return sound / max(1e-9, float(np.sqrt(np.mean(sound**2))))


def _slow(rng: np.random.Generator, n: int, hertz: float = 0.7) -> Wave:
    """A curve within -1 and 1 that changes so often a second."""
    points = rng.uniform(-1, 1, int(n / RATE_HZ * hertz) + 3)
    return np.interp(np.arange(n) * hertz / RATE_HZ, np.arange(points.size), points)


def _driven(rng: np.random.Generator, n: int) -> Wave:
    """A speed, 0 to 1: standing, speeding up, cruising and braking by turns."""
    times, speeds = [0.0], [0.0]
    while times[-1] < n / RATE_HZ:
        speed = rng.uniform(0.3, 1)
        for takes_s, reached in (
            (rng.uniform(0.2, 2.0), 0.0),
            (rng.uniform(0.2, 1.5), speed),
            (rng.uniform(0.5, 4.0), speed * rng.uniform(0.9, 1.1)),
            (rng.uniform(0.2, 1.0), 0.0),
        ):
            times.append(times[-1] + takes_s)
            speeds.append(reached)
    return np.interp(np.arange(n) / RATE_HZ, times, speeds)


def _harmonics(rng: np.random.Generator, base: Wave, number: int) -> Wave:
    phase = 2 * np.pi * np.cumsum(base) / RATE_HZ
    return sum(
        rng.uniform(0.3, 1) / k**0.8 * np.sin(k * phase + rng.uniform(0, 6))
        for k in range(1, number)
    )
