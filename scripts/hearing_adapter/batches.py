"""Utterances as Whisper takes them: bands, and the tokens before and of what was said."""

import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from faster_whisper.feature_extractor import FeatureExtractor
from faster_whisper.tokenizer import Tokenizer
from tokenizers import Tokenizer as Words

from edgevox.voice.audio import Samples
from edgevox.voice.level import FULL_SCALE
from hearing_adapter.utterances import Utterance, Utterances, prompt

SIZE, OF_A_KIND, WHOLE = 24, 8, 6
"""So many utterances are learnt from at once, so many such batches are made of equally long ones,
and so many utterances at once in Whisper's own 30 s.
"""
WHOLE_SHARE, PROMPT_SHARE = 0.05, 0.75
ROWS_AFTER = (10, 200)
"""So many rows of 10 ms follow what was heard."""
_WHOLE_ROWS, _ROW = 3_000, 160
UNWANTED, AS_TAUGHT = -1, -2


@dataclass(frozen=True, slots=True)
class Batch:
    """Bands (sounds, bands, rows) as said and as heard; tokens (sounds, tokens), and what follows
    each: a token, `UNWANTED`, or `AS_TAUGHT` where it is what Whisper makes of the sound as said.
    """

    said: torch.Tensor
    heard: torch.Tensor
    tokens: torch.Tensor
    follow: torch.Tensor


class Batches:
    """Makes batches of utterances for the model in this folder."""

    def __init__(self, folder: Path, seed: int) -> None:
        words = Words.from_file(str(folder / "tokenizer.json"))
        self._tokenizer = Tokenizer(words, False, task="transcribe", language="en")
        self._features = FeatureExtractor()
        self._rng, self._drawn = np.random.default_rng((seed, 1)), random.Random(seed)

    @property
    def no_speech(self) -> int:
        """The token of a sound in which nobody speaks."""
        return int(self._tokenizer.no_speech)

    def of(self, utterances: Utterances) -> Iterator[Batch]:
        """Some, in no order."""
        made = sorted(
            (utterances.make() for _ in range(SIZE * OF_A_KIND)), key=lambda one: one.heard.size
        )
        for at in self._rng.permutation(OF_A_KIND) * SIZE:
            some = made[at : at + SIZE]
            if self._rng.random() < WHOLE_SHARE:
                yield self._batch(some[:WHOLE], _WHOLE_ROWS)
            rows = some[-1].heard.size // _ROW + int(self._rng.integers(*ROWS_AFTER))
            yield self._batch(some, min(rows + rows % 2, _WHOLE_ROWS))

    def _batch(self, some: list[Utterance], rows: int) -> Batch:
        pairs = [self._tokens(one.text) for one in some]
        longest = max(len(before) + len(of_text) for before, of_text in pairs) - 1
        tokens = np.full((len(some), longest), self._tokenizer.eot)
        follow = np.full((len(some), longest), UNWANTED)
        for row, (one, (before, of_text)) in enumerate(zip(some, pairs, strict=True)):
            whole = [*before, *of_text]
            tokens[row, : len(whole) - 1] = whole[:-1]
            follow[row, len(before) - 1 : len(whole) - 1] = of_text
            follow[row, len(before) - 2] = AS_TAUGHT if one.text else self.no_speech
        return Batch(
            torch.from_numpy(np.stack([self._bands(one.said, rows) for one in some])),
            torch.from_numpy(np.stack([self._bands(one.heard, rows) for one in some])),
            torch.from_numpy(tokens),
            torch.from_numpy(follow),
        )

    def _tokens(self, text: str) -> tuple[list[int], list[int]]:
        """Those before what is said, some of them a prompt, and those of it."""
        shown = prompt(self._drawn, text) if self._rng.random() < PROMPT_SHARE else ""
        words = self._tokenizer
        before = [words.sot_prev, *words.encode(f" {shown}")] if shown else []
        of_text = words.encode(f" {text}") if text else []
        return [*before, words.sot, words.no_timestamps], [*of_text, words.eot]

    def _bands(self, sound: Samples, rows: int) -> np.ndarray:
        found = self._features(sound.astype(np.float32) / FULL_SCALE)[..., :-1]
        return np.pad(found, ((0, 0), (0, max(0, rows - found.shape[1]))))[:, :rows]
