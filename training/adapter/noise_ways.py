"""Other ways to help commands in noise, each beside the product.

WebRTC's noise suppression and gain control process all sound before voice activity; `whisper-base`
is the next larger model, without an adapter. The commands of `noise`, by the tuning voices in their
noises and rooms, at 10 dB and at 5 dB.
"""

import itertools
from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.heard_robot import MODEL, Outcome, Robot, outcome_figure
from benchmarks.hearing.noise import COMMANDS, CONDITIONS, Condition, skills_of_robots, spoken
from edgevox.models import ModelMissing
from edgevox.voice.audio import RATE_HZ, Samples
from training.acoustics import Half
from training.acoustics.noises import kinds
from training.acoustics.voices import kokoro_voices

TABLE = "Commands in noise, other ways"
MODERATE, HIGH = 1, 3
"""Levels of WebRTC's noise suppression: 12 dB and 21 dB."""
LARGER = "whisper-base"
CHUNK = RATE_HZ // 100
"""WebRTC takes 10 ms at a time."""
Way = Callable[[Samples], Samples]
Robots = dict[str, dict[str, Robot]]
"""Of each model, by name."""


def measure(quick: bool = False) -> Measured:
    """All ways hear the same sounds."""
    try:
        robots = {
            model: {name: Robot(name, model) for name in skills_of_robots()}
            for model in (MODEL, LARGER)
        }
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    figures = [
        one
        for condition in CONDITIONS
        if condition.snr_db is not None
        for one in _figures(condition, Counter(_outcomes(robots, condition, quick)))
    ]
    return Measured(figures=tuple(figures))


def _outcomes(robots: Robots, condition: Condition, quick: bool) -> Iterator[tuple[str, Outcome]]:
    voices, beside = kokoro_voices(Half.TUNING), kinds(Half.TUNING)
    every = list(itertools.product(COMMANDS, voices))
    for seed, ((robot, text, wanted), voice) in enumerate(every[:: 17 if quick else 1]):
        kind = beside[seed % len(beside)]
        sound = spoken(voice, text, condition, kind, seed, half=Half.TUNING)
        for way, (model, through) in WAYS.items():
            hears = robots[model][robot]
            yield way, hears.does(hears.hear(through(sound)), wanted)


def _figures(condition: Condition, found: Counter[tuple[str, Outcome]]) -> Iterator[Figure]:
    for number, way in enumerate(WAYS):
        of = sum(found[way, outcome] for outcome in Outcome)
        for outcome in (Outcome.RIGHT, Outcome.ASKED, Outcome.WRONG):
            yield outcome_figure(
                outcome, found[way, outcome], of,
                id=f"{condition.name}.{number}.{outcome.name.lower()}", table=TABLE, what=way,
                column=f"{outcome.value}, {condition.about}",
            )  # fmt: skip


def _as_it_is(sound: Samples) -> Samples:
    return sound


def _suppressed(level: int) -> Way:
    def through(sound: Samples) -> Samples:
        from pywebrtc_audio import NoiseSuppressor

        return _in_chunks(NoiseSuppressor(RATE_HZ, level=level).process, sound)

    return through


def _gained(sound: Samples) -> Samples:
    from pywebrtc_audio import GainController

    return _in_chunks(GainController(RATE_HZ).process, sound)


def _in_chunks(process: Way, sound: Samples) -> Samples:
    whole = sound[: sound.size // CHUNK * CHUNK]
    return np.concatenate([process(chunk) for chunk in whole.reshape(-1, CHUNK)])


WAYS: dict[str, tuple[str, Way]] = {
    "as the product does it": (MODEL, _as_it_is),
    "noise suppression, moderate": (MODEL, _suppressed(MODERATE)),
    "noise suppression, high": (MODEL, _suppressed(HIGH)),
    "gain control": (MODEL, _gained),
    "whisper-base in English": (LARGER, _as_it_is),
}
"""A model each, and what its sound goes through."""
