"""The benchmark and the training of the stop word spotter, without a voice that speaks."""

import numpy as np
import pytest

from benchmarks.core.figures import Figure, NotHere, wilson
from benchmarks.core.tables import interval
from benchmarks.hearing.stop_words import ears as stop_words_ears
from benchmarks.hearing.stop_words import english as stop_words
from benchmarks.hearing.stop_words import sounds as stop_words_sounds
from training.acoustics import Half, clips, languages, noises, sentences, voices
from training.spotter import clips as training_clips
from training.spotter import examples, installing, language_clips, texts
from training.spotter import languages as outputs
from training.spotter import threshold as stop_words_threshold
from training.spotter import train as train_stop_spotter

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
