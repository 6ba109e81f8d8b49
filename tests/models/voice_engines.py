"""The voices and the speech recognition that the tests of speech share."""

import re
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from faster_whisper import WhisperModel

from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ, Chunk
from edgevox.voice.tts.voices import VoiceChoice, VoicePool
from edgevox.voice.wav import resampled


def voice(language: str, name: str) -> VoiceChoice:
    """A voice by its name. Raises `ModelMissing` naming the command that fetches what it needs."""
    found = next(one for one in LANGUAGES[language].voices if one.name == name)
    return VoiceChoice(language, found, tuple(locate(model) for model in found.models))


def speak(choice: VoiceChoice, text: str, pool: VoicePool) -> list[Chunk]:
    return list(pool.get(choice).synthesise(text, CancelToken()))


def hear(chunks: Sequence[Chunk], language: str) -> list[str]:
    """The words of a recording, by Whisper, without case and marks."""
    sound = np.concatenate([resampled(one.samples, one.rate_hz, RATE_HZ) for one in chunks])
    segments, _ = _listener("whisper-tiny.en" if language == "en" else "whisper-base").transcribe(
        sound.astype(np.float32) / 32768,
        language=language,
        beam_size=1,
        temperature=0,
        without_timestamps=True,
    )
    return words("".join(segment.text for segment in segments))


def words(text: str) -> list[str]:
    return re.findall(r"\w+", text.casefold())


def wrong_words(said: Sequence[str], heard: Sequence[str]) -> int:
    """The edit distance in words."""
    row = list(range(len(heard) + 1))
    for i, one in enumerate(said, 1):
        before, row[0] = row[0], i
        for j, other in enumerate(heard, 1):
            before, row[j] = (
                row[j],
                min(row[j] + 1, row[j - 1] + 1, before + (one != other)),
            )
    return row[-1]


@lru_cache(maxsize=1)
def _listener(model_id: str) -> WhisperModel:
    return WhisperModel(str(locate(model_id)), device="cpu", compute_type="int8", cpu_threads=2)
