"""The wake word: openWakeWord's networks, a frame at a time. Products may not use them.

While nobody speaks the networks sleep: they cost more than ten times as much as the voice detector.
A phrase that begins almost like the wake word may wake it ("hey Java", "hey Charles" for "hey
jarvis").
"""

from pathlib import Path

import numpy as np
from pyopen_wakeword import OpenWakeWord, OpenWakeWordFeatures

from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.word_detection import KEPT_S, QUIET_S, OncePerWord, WakeSleep

THRESHOLD = 0.5

_CHUNK_SAMPLES = 1280  # what the networks take at once
_NOT_PHRASES = ("embedding_model", "melspectrogram")


class WakeWord:
    """Listens for one phrase, such as ``hey jarvis``; `folder` holds the networks.

    Raises `InvalidValue` for a phrase without a network. Loading warms up, which takes 0.5 s.
    """

    def __init__(self, phrase: str, folder: Path, *, always_awake: bool = False) -> None:
        self.phrase = " ".join(phrase.casefold().replace("_", " ").split())
        name = self.phrase.replace(" ", "_")
        if name not in _names(folder):
            raise InvalidValue("wakeword", phrase, "one of " + ", ".join(phrases(folder)))
        self._features = OpenWakeWordFeatures.from_builtin(folder)
        self._network = OpenWakeWord.from_model(folder / f"{name}.tflite")
        self._sleep = WakeSleep(always_awake=always_awake)
        self._chunk: list[Samples] = []
        self._once = OncePerWord(QUIET_S)
        self._run(np.zeros(_CHUNK_SAMPLES, np.int16))
        self.likelihood = 0.0

    def heard(self, samples: Samples, probability: float) -> bool:
        self._chunk += self._sleep.push(samples, probability)
        return self._once.counts(self._found())

    def reset(self) -> None:
        self._sleep.reset()
        self._once.forget()
        self._chunk.clear()
        self._run(np.zeros(round(KEPT_S * RATE_HZ), np.int16))
        self.likelihood = 0.0

    def close(self) -> None:
        self._features.close()
        self._network.close()

    def _found(self) -> bool:
        """Return whether the phrase ends in the sound since the networks were last asked."""
        if len(self._chunk) * FRAME_SAMPLES < _CHUNK_SAMPLES:
            return False
        self.likelihood = self._run(np.concatenate(self._chunk))
        self._chunk.clear()
        return self.likelihood >= THRESHOLD

    def _run(self, samples: Samples) -> float:
        """The highest probability that the phrase ends in here."""
        return max(
            (
                probability
                for embedding in self._features.process_streaming(samples.tobytes())
                for probability in self._network.process_streaming(embedding)
            ),
            default=0.0,
        )


def phrases(folder: Path) -> list[str]:
    """The wake words whose networks are in this folder."""
    return [name.replace("_", " ") for name in _names(folder)]


def _names(folder: Path) -> list[str]:
    return sorted(p.stem for p in folder.glob("*.tflite") if p.stem not in _NOT_PHRASES)
