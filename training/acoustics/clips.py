"""Clips: who says what, how; spoken once, then kept."""

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from edgevox.voice.audio import Samples
from training.acoustics.voices import is_cached, say

_TOLD_EVERY = 50


@dataclass(frozen=True, slots=True)
class Clip:
    """Something said. `word` is the stop word in it; it ends the clip unless it is `within`.

    `speed` is for Kokoro, `pitch` and `words_a_minute` are for espeak-ng.
    """

    voice: str
    text: str
    word: str = ""
    within: bool = False
    speed: float = 1.0
    pitch: int = 50
    words_a_minute: int = 175

    @property
    def engine(self) -> str:
        return self.voice.split(":", maxsplit=1)[0]

    @property
    def samples(self) -> Samples:
        """Its sound, synthesised if it was not before."""
        return say(self.voice, self.text, **self._options)

    @property
    def is_here(self) -> bool:
        """Whether it was synthesised before."""
        return is_cached(self.voice, self.text, **self._options)

    @property
    def _options(self) -> dict[str, float | int]:
        return {
            "speed": self.speed,
            "pitch": self.pitch,
            "words_a_minute": self.words_a_minute,
        }


def espeak_manner(rng: random.Random, slowest: int = 130, fastest: int = 220) -> dict[str, int]:
    """How high, and at how many words a minute, espeak-ng says a clip."""
    return {"pitch": rng.randint(20, 85), "words_a_minute": rng.randint(slowest, fastest)}


def speak(clips: Iterable[Clip], told: Callable[[str], None]) -> None:
    """Synthesise those that are not there yet, and tell how far it is.

    Whoever breaks it off loses nothing. Raises `ModelMissing` where a voice is not here.
    """
    missing = [clip for clip in dict.fromkeys(clips) if not clip.is_here]
    for number, clip in enumerate(missing, 1):
        _ = clip.samples
        if number % _TOLD_EVERY == 0 or number == len(missing):
            told(f"{number} of {len(missing)} clips spoken, the last by {clip.voice}")


def of_engine(clips: Sequence[Clip]) -> Mapping[str, Sequence[Clip]]:
    """The clips by engine, in the order in which they first come."""
    engines = dict.fromkeys(clip.engine for clip in clips)
    return {engine: [clip for clip in clips if clip.engine == engine] for engine in engines}


def standing_on(what: str, clips: Sequence[Clip]) -> tuple[str, ...]:
    """What figures stand on, a line an engine: how many clips, of which voices."""
    return tuple(
        f"{what}: {len(set(some)):,} clips of {_voices(engine, some)}"
        for engine, some in of_engine(clips).items()
    )


def _voices(engine: str, clips: Sequence[Clip]) -> str:
    names = sorted({clip.voice.removeprefix(f"{engine}:") for clip in clips})
    if engine == "espeak":
        people = sorted({name.rpartition("+")[2] for name in names})
        accents = {name.rpartition("+")[0] for name in names}
        return f"espeak-ng, {len(people)} speakers in {len(accents)} accents: {', '.join(people)}"
    return f"{engine.title()}, {len(names)} voices: {', '.join(names)}"
