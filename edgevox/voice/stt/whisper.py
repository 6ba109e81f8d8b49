"""Whisper, by faster-whisper: 8 bit, greedy, on the CPU."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from edgevox.core.cgroup import usable_cpus
from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.level import FULL_SCALE
from edgevox.voice.stt.hallucinations import (
    Segment,
    confidence_in,
    parroted,
    plausible,
    words_of,
)
from edgevox.voice.stt.speech_to_text import Transcript

MAX_THREADS = 4
"""More do not help one utterance."""
TOKENS_PER_S = 10
"""Nobody speaks faster; a hallucination that repeats itself ends there."""
MORE_TOKENS = 16
_WARM_UP = np.zeros(RATE_HZ, np.int16)


class Whisper:
    """Loads each model once, when its language is first wanted; they are kept.

    `model_of` gives a language's model folder. `prompt_of` gives a language's text in the manner in
    which commands should be written ("Go to x 2, y minus 1.5."): Whisper takes over its spelling
    of numbers and coordinates, and its words.
    """

    def __init__(
        self,
        model_of: Callable[[str], Path],
        *,
        prompt_of: Callable[[str], str] = lambda _: "",
        threads: int = 0,
    ) -> None:
        self._model_of = model_of
        self._prompt_of = prompt_of
        self._threads = threads or min(MAX_THREADS, usable_cpus())
        self._models: dict[Path, Any] = {}
        self._paths: dict[str, Path] = {}  # of what is loaded: its files may be gone since
        self._lock = threading.Lock()

    def warm_up(self, language: str) -> None:
        self.transcribe(_WARM_UP, language)

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        path = self._paths.get(language) or self._model_of(language)
        seconds, prompt = samples.size / RATE_HZ, self._prompt_of(language)
        with self._lock:
            model = self._model(path)
            self._paths[language] = path
            found, _ = model.transcribe(
                samples.astype(np.float32) / FULL_SCALE,
                language=language,
                beam_size=1,
                temperature=0.0,
                without_timestamps=True,
                condition_on_previous_text=False,
                initial_prompt=prompt or None,
                max_new_tokens=MORE_TOKENS + int(seconds * TOKENS_PER_S),
            )
            segments = [
                Segment(s.text, s.no_speech_prob, s.avg_logprob, s.compression_ratio) for s in found
            ]
        said = [s for s in segments if plausible(s, seconds) and not parroted(s, prompt)]
        return Transcript(words_of(said), confidence_in(said))

    @property
    def loaded(self) -> tuple[Path, ...]:
        """The folders of the models that are loaded. May be read from any thread."""
        return tuple(self._models.copy())

    def close(self) -> None:
        """Forget the models."""
        with self._lock:
            self._models.clear()

    def _model(self, path: Path) -> Any:
        if path not in self._models:
            from faster_whisper import WhisperModel

            try:
                self._models[path] = WhisperModel(
                    str(path),
                    device="cpu",
                    compute_type="int8",
                    cpu_threads=self._threads,
                    local_files_only=True,
                )
            except (RuntimeError, ValueError, OSError, MemoryError) as error:
                raise EdgeVoxError(f"speech to text: cannot load {path}: {error}") from error
        return self._models[path]
