"""Whisper, by faster-whisper: 8 bit, on the CPU, with several hypotheses for each utterance.

A model with an adapter hears better in noise, and processes only the speech, not 30 s. Words that
it is not sure of are heard again by the same model with a part of the adapter; both count.

In a language whose `[stop]` table says so, a short utterance that is not sure is searched again
with stop words shown, only for a stop word: a lone word is what Whisper hears worst.
"""

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from edgevox.core.commands import Hypothesis
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import STOP_WORDS
from edgevox.core.process import usable_cpus
from edgevox.voice.audio import FULL_SCALE, RATE_HZ, Samples
from edgevox.voice.stt.adapter import Added, adapted_folder, adapter_for, weakened
from edgevox.voice.stt.speech_to_text import (
    Segment,
    Transcript,
    both,
    heard_again,
    heard_for,
    is_doubtful,
    is_sure,
    only_alone,
    stop_word_parroted,
    transcript_of,
)

MAX_THREADS = 4
"""More do not help one utterance."""
TOKENS_PER_S = 10
"""No person speaks faster; a hallucination that repeats itself ends there."""
MORE_TOKENS = 16
HYPOTHESES = 5
"""The width of the beam: of the commands in noise a fifth more are among five than come first."""
WIDTHS = {"en": (HYPOTHESES,)}
"""Beam widths of the searches in a language; the first one has the words. Measured in English."""
OTHER_WIDTHS = (1, HYPOTHESES)
"""In Portuguese a greedy search's words are right more often than the first of a beam."""
SHORT_S = 9.0
"""No longer sound was learnt by the adapter but in Whisper's own 30 s."""
ROWS_A_SECOND, ROWS_AFTER, FEWEST_ROWS = 100, 64, 240
"""Rows of Whisper's features per second of sound, the rows that follow the speech where less than
30 s is listened to, and the fewest in all: in 160 rows a lone "yes" was heard as "I'm". The tuning
voices lost 4 of 64 answers in quiet so, and with 240 rows none."""
SECOND_SHARE = 0.25
"""The part of the adapter with which a model hears again. Chosen with real people's orders by the
half of the speakers that `benchmarks/hearing/people.py` does not report."""
STOP_S = 2.0
"""Seconds of the longest utterance that is heard again for a stop word; few said alone take 1.3."""
LEAST = 1e-9
"""The least probability of a token."""
_WARM_UP = np.zeros(RATE_HZ, np.int16)


class _LoadedModel(NamedTuple):
    """A model that is loaded: as it hears first, and with less of its adapter, if it has one."""

    engine: Any
    second: Any = None

    @property
    def weaker(self) -> "_LoadedModel":
        """The same model as it hears again."""
        return self._replace(engine=self.second)

    @property
    def short(self) -> bool:
        """Whether it needs to hear no more than was said."""
        return self.second is not None


class Whisper:
    """Whisper models, each loaded when its language is first needed, and then kept.

    Args:
        model_of: Returns the model folder of a language.
        prompt_of: Returns a text in the manner in which commands should be written ("Go to x 2, y
            minus 1.5."): Whisper takes over its spelling of numbers and coordinates, and its words.
        threads: CPU threads; 0 chooses by the CPUs.
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
        self._models: dict[Path, _LoadedModel] = {}
        self._paths: dict[str, Path] = {}  # of what is loaded: its files may be gone since
        self._lock = threading.Lock()

    def warm_up(self, language: str) -> None:
        self.transcribe(_WARM_UP, language)

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        prompt = self._prompt_of(language)
        with self._lock:
            model, seconds = self._model_for(language), samples.size / RATE_HZ
            heard = _EncodedSound(model, samples, language)
            said = heard.transcript(prompt, seconds)
            if model.second is not None:
                again = cache(partial(_EncodedSound, model.weaker, samples, language))
                if is_doubtful(said, language):
                    said = both(said, again().transcript(prompt, seconds))
                said = replace(said, rate=partial(self._rate, again))
            shown = STOP_WORDS[language].shown
            if shown and seconds <= STOP_S and not is_sure(said):
                said = replace(said, stops=heard.stops(shown, seconds))
            return said

    def _rate(self, sound: "Callable[[], _EncodedSound]", texts: Sequence[str]) -> Sequence[float]:
        found = []
        for text in texts:
            with self._lock:  # for one text at a time: a stop word may be waiting to be heard
                found.append(sound().rate(text))
        return found

    def hypotheses(self, samples: Samples, language: str, prompt: str = "") -> list[Segment]:
        """Return the hypotheses for the first 30 s, with Whisper's doubts.

        The likeliest comes first.
        """
        with self._lock:
            return _EncodedSound(self._model_for(language), samples, language).hypotheses(prompt)

    @property
    def loaded(self) -> tuple[Path, ...]:
        """The folders of the models that are loaded. May be read from any thread."""
        return tuple(self._models.copy())

    def close(self) -> None:
        """Forget the models."""
        with self._lock:
            self._models.clear()

    def _model_for(self, language: str) -> _LoadedModel:
        path = self._paths.get(language) or self._model_of(language)
        model = self._model(path)
        self._paths[language] = path
        return model

    def _model(self, path: Path) -> _LoadedModel:
        if path not in self._models:
            try:
                (path / "tokenizer.json").stat()  # without it faster-whisper asks a model hub
                added = adapter_for(path)
                second = self._open(path, weakened(added, SECOND_SHARE)) if added else None
                self._models[path] = _LoadedModel(self._open(path, added), second)
            except Exception as error:  # its libraries raise whatever they like for a file
                raise EdgeVoxError(f"speech to text: cannot load {path}: {error}") from error
        return self._models[path]

    def _open(self, path: Path, added: Mapping[str, Added]) -> Any:
        from faster_whisper import WhisperModel

        with adapted_folder(path, added) if added else nullcontext(path) as folder:
            return WhisperModel(
                str(folder),
                device="cpu",
                compute_type="int8",
                cpu_threads=self._threads,
                local_files_only=True,
            )


class _EncodedSound:
    """A sound as the encoder of a model hears it, in a language."""

    def __init__(self, loaded: _LoadedModel, samples: Samples, language: str) -> None:
        from faster_whisper.tokenizer import Tokenizer

        self._engine, self._language = loaded.engine, language
        self._tokenizer = Tokenizer(
            self._engine.hf_tokenizer,
            self._engine.model.is_multilingual,
            task="transcribe",
            language=language,
        )
        sound = samples.astype(np.float32) / FULL_SCALE
        features = self._engine.feature_extractor(sound)[..., :-1]
        self._encoded = self._engine.encode(as_listened_to(features, loaded.short))
        self._most_tokens = MORE_TOKENS + int(samples.size / RATE_HZ * TOKENS_PER_S)

    def transcript(self, prompt: str, seconds: float) -> Transcript:
        """What is heard in so many seconds; again without the prompt, if the words are not sure."""
        found = self.hypotheses(prompt)
        said = transcript_of(found, seconds, prompt)
        if not (prompt and is_doubtful(said, self._language)):
            return said
        alone = self.hypotheses()
        if stop_word_parroted(said.text, STOP_WORDS[self._language].anywhere, alone):
            without = transcript_of(alone, seconds, "", only_alone)
            if without.text:
                return without
        return transcript_of(found, seconds, prompt, heard_again(alone))

    def stops(self, shown: Sequence[str], seconds: float) -> tuple[Hypothesis, ...]:
        """What is heard where these stop words are shown."""
        found = self.hypotheses(" ".join(f"{word}!" for word in shown), (HYPOTHESES,))
        return heard_for(found, seconds)

    def hypotheses(self, prompt: str = "", widths: Sequence[int] = ()) -> list[Segment]:
        """Return hypotheses as `WhisperModel.transcribe` finds them.

        It returns only one of them.
        """
        from faster_whisper.transcribe import get_compression_ratio, get_suppressed_tokens

        model, tokenizer = self._engine.model, self._tokenizer
        shown = tokenizer.encode(f" {prompt.strip()}") if prompt else []
        start = self._engine.get_prompt(tokenizer, shown, without_timestamps=True)
        suppressed = get_suppressed_tokens(tokenizer, [-1])
        segments: dict[str, Segment] = {}
        for width in widths or WIDTHS.get(self._language, OTHER_WIDTHS):
            found = model.generate(
                self._encoded,
                [start],
                beam_size=width,
                num_hypotheses=width,
                max_length=min(len(start) + self._most_tokens, self._engine.max_length),
                return_scores=True,
                return_no_speech_prob=True,
                suppress_tokens=suppressed,
            )[0]
            for tokens, score in zip(found.sequences_ids, found.scores, strict=True):
                text, whole = tokenizer.decode(tokens), score * len(tokens)
                mean = whole / (len(tokens) + 1)  # its last token, which ends it, counts
                ratio = get_compression_ratio(text.strip())
                segments.setdefault(text, Segment(text, found.no_speech_prob, mean, ratio, whole))
        return [*segments.values()]

    def rate(self, text: str) -> float:
        """Return how likely this text was said: the sum of its tokens' log probabilities."""
        tokens = self._tokenizer.encode(f" {text.strip()}")
        (found,) = self._engine.model.align(
            self._encoded,
            [*self._tokenizer.sot_sequence],
            [tokens],
            self._engine.feature_extractor.nb_max_frames,
        )
        return sum(math.log(max(one, LEAST)) for one in found.text_token_probs[: len(tokens)])


def as_listened_to(features: NDArray[np.float32], short: bool) -> NDArray[np.float32]:
    """Return features (bands, rows of 10 ms) with the rows that follow them.

    At most 30 s in all.
    """
    from faster_whisper.audio import pad_or_trim

    rows = features.shape[-1]
    if not short or rows > SHORT_S * ROWS_A_SECOND:
        return np.asarray(pad_or_trim(features))
    # Two rows make one step of the encoder.
    return np.asarray(pad_or_trim(features, max(rows + ROWS_AFTER + rows % 2, FEWEST_ROWS)))
