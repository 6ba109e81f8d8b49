"""A loudspeaker beside a microphone, without any model: a voice is a buzz through changing filters,
in syllables. Everything is drawn from seeds.
"""

import numpy as np

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Frame

LATE_S = 5.0
"""The clock's time of the first sample: no clock begins at 0."""


def voice(seconds, seed, level=0.1):
    """Something like speech at 16 kHz, shape (n,), as loud as `level`."""
    rng = np.random.default_rng(seed)
    syllables = []
    while sum(one.size for one in syllables) < seconds * RATE_HZ:
        count = int(rng.uniform(0.12, 0.3) * RATE_HZ)
        pitch = rng.uniform(90, 220) * (1 + 0.1 * np.linspace(-1, 1, count))
        buzz = np.sign(np.sin(2 * np.pi * np.cumsum(pitch) / RATE_HZ)) + rng.normal(0, 0.3, count)
        colour = rng.normal(0, 1, 24) * np.exp(-np.arange(24) / 8)
        sound = np.convolve(buzz, colour, "same") * np.hanning(count)
        syllables.append(sound / np.sqrt(np.mean(sound**2)))
    return level * np.concatenate(syllables)[: round(seconds * RATE_HZ)]


def room(sound, *, delay_s=0.08, gain=0.5, seed=3):
    """What comes back of it: later, weaker, with a room's sound behind it."""
    rng = np.random.default_rng(seed)
    count = round(0.2 * RATE_HZ)
    response = 0.05 * rng.normal(0, 1, count) * np.exp(-6.9 * np.arange(count) / count)
    response[0] = 1.0
    late = np.concatenate([np.zeros(round(delay_s * RATE_HZ)), sound])[: sound.size]
    heard = gain * _convolved(late, response)
    return heard + rng.normal(0, 0.0005, sound.size)


def _convolved(sound, response):
    """As long as the sound. By way of its spectrum: sample by sample takes seconds."""
    size = 1 << (sound.size + response.size - 1).bit_length()
    spectrum = np.fft.rfft(sound, size) * np.fft.rfft(response, size)
    return np.fft.irfft(spectrum, size)[: sound.size]


def samples(sound):
    return np.clip(np.rint(sound * 32768), -32768, 32767).astype(np.int16)


def through(echo, played, heard, reference, *, told=True, late_s=lambda: 0.0):
    """Each frame of what is heard, as the filter gives it on; `reference` is told the other."""
    for number in range(heard.size // FRAME_SAMPLES):
        at = slice(number * FRAME_SAMPLES, (number + 1) * FRAME_SAMPLES)
        if told:
            reference.add(samples(played[at]), RATE_HZ, LATE_S + number * FRAME_S)
        end_s = LATE_S + (number + 1) * FRAME_S + late_s()
        yield echo.hear(Frame(samples(heard[at]), end_s))


def decibels(one, other):
    """By how much the one is louder, over all of both."""
    return 10 * np.log10(np.mean(one.astype(float) ** 2) / np.mean(other.astype(float) ** 2))
