"""The benchmark and the training of the stop word spotter, without a voice that speaks."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
sys.path.insert(0, str(Path(__file__).parents[1] / "scripts"))

import stop_words
import stop_words_ears
import stop_words_sounds
import stop_words_threshold
import train_stop_spotter
from acoustics import Half, clips, languages, noises, sentences, voices
from figures import Figure, NotHere, wilson
from stop_spotter import clips as training_clips
from stop_spotter import examples, installing, language_clips, texts
from stop_spotter import languages as outputs
from tables import interval

__all__ = [
    "Figure",
    "Half",
    "NotHere",
    "Speaker",
    "clips",
    "examples",
    "installing",
    "interval",
    "language_clips",
    "languages",
    "outputs",
    "sentences",
    "stop_words",
    "stop_words_ears",
    "stop_words_sounds",
    "stop_words_threshold",
    "texts",
    "train_stop_spotter",
    "training_clips",
    "voices",
    "wilson",
]


TONE = (3000 * np.sin(np.arange(8_000) / 9)).astype(np.int16)


class Speaker:
    """Stands in for all voices: half a second of a tone, kept as the cache keeps it."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.said: list[tuple[str, str]] = []
        self._kept: set[tuple[object, ...]] = set()
        patch.setattr(clips, "say", self.say)
        patch.setattr(noises, "say", self.say)
        patch.setattr(clips, "is_cached", self.knows)

    def say(self, voice: str, text: str, **options: float) -> np.ndarray:
        """Speak, once."""
        if not self.knows(voice, text, **options):
            self.said.append((voice, text))
            self._kept.add((voice, text, *sorted(options.items())))
        return TONE.copy()

    def knows(self, voice: str, text: str, **options: float) -> bool:
        """Whether it spoke this."""
        return (voice, text, *sorted(options.items())) in self._kept
