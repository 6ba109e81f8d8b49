"""The parts of the voice, each measured alone: how much faster than speech they are.

A real-time factor is seconds of work for a second of sound; the median of the sentences. Run with
the machine otherwise idle.
"""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from faster_whisper import WhisperModel

from edgevox.apps.agent.queries import find_model
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES
from edgevox.voice.audio import RATE_HZ, Chunk
from edgevox.voice.sentence_synthesiser import split_phrases
from edgevox.voice.tts.synthesiser import Synthesiser
from edgevox.voice.tts.voices import VoiceChoice, VoicePool, choose
from edgevox.voice.wav import resampled

SENTENCES = (
    "I am on my way.",
    "The robot drives to the kitchen and picks up the red cup.",
    "I have put the cube into the left bin, and now I will come back to the door, as you asked.",
)
_CLOCK = SystemClock()


@dataclass(frozen=True, slots=True)
class Measured:
    """One part; `first_s` is the time to its first sound, `load_s` the time until it was warm."""

    name: str
    load_s: float
    factor: float
    first_s: float


def measure_voices(language: str = "en", sentences: Sequence[str] = SENTENCES) -> list[Measured]:
    """The best voice of every engine that the language has here."""
    return [measure_voice(choice, sentences) for choice in choose(language, "", find_model)]


def measure_voice(choice: VoiceChoice, sentences: Sequence[str] = SENTENCES) -> Measured:
    """Load a voice and let it say the sentences, in the phrases that are made of them."""
    began_s = _CLOCK.now()
    engine = VoicePool().get(choice)
    load_s = _CLOCK.now() - began_s
    runs = [_say(engine, sentence) for sentence in sentences]
    return Measured(
        choice.name,
        load_s,
        statistics.median(work_s / sound_s for work_s, sound_s, _ in runs),
        statistics.median(first_s for _, _, first_s in runs),
    )


def measure_speech_to_text(
    recordings: Sequence[Chunk], language: str = "en", threads: int = 2
) -> Measured:
    """Load the language's speech-to-text model and let it hear the recordings."""
    path = find_model(LANGUAGES[language].stt_model)
    assert path is not None, f"edgevox-models fetch {LANGUAGES[language].stt_model}"
    began_s = _CLOCK.now()
    whisper = WhisperModel(str(path), device="cpu", compute_type="int8", cpu_threads=threads)
    _hear(whisper, recordings[0], language)
    load_s = _CLOCK.now() - began_s
    took = [_hear(whisper, recording, language) for recording in recordings]
    seconds = [len(one.samples) / one.rate_hz for one in recordings]
    factor = statistics.median(work / sound for work, sound in zip(took, seconds, strict=True))
    return Measured(Path(path).name, load_s, factor, statistics.median(took))


def record(choice: VoiceChoice, sentences: Sequence[str] = SENTENCES) -> list[Chunk]:
    """The sentences as sound, for speech to text."""
    engine = VoicePool().get(choice)
    pieces = [list(engine.synthesise(sentence, CancelToken())) for sentence in sentences]
    return [
        Chunk(np.concatenate([piece.samples for piece in one]), one[0].rate_hz) for one in pieces
    ]


def _say(engine: Synthesiser, sentence: str) -> tuple[float, float, float]:
    """Seconds of work, of sound, and to the first sound."""
    began_s, first_s, sound_s = _CLOCK.now(), 0.0, 0.0
    for phrase in split_phrases(sentence, engine.phrase_chars):
        for chunk in engine.synthesise(phrase, CancelToken()):
            first_s = first_s or _CLOCK.now() - began_s
            sound_s += len(chunk.samples) / chunk.rate_hz
    return _CLOCK.now() - began_s, sound_s, first_s


def _hear(whisper: WhisperModel, recording: Chunk, language: str) -> float:
    sound = resampled(recording.samples, recording.rate_hz, RATE_HZ).astype(np.float32) / 32768
    began_s = _CLOCK.now()
    segments, _ = whisper.transcribe(
        sound, language=language, beam_size=1, temperature=0, without_timestamps=True
    )
    assert list(segments), "nothing was heard"
    return _CLOCK.now() - began_s
