"""Utterances as Whisper takes them: what is said, and the tokens before and of it."""

import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from faster_whisper.tokenizer import Tokenizer
from tokenizers import Tokenizer as Words
from torch.nn.utils.rnn import pad_sequence
from torch.utils.data import IterableDataset, get_worker_info

from edgevox.voice.stop_spotter.network import HOP_SAMPLES
from training.acoustics.clips import Clip
from training.adapter.utterances import Utterance, Utterances, prompt

OF_A_KIND, WHOLE = 8, 4
"""So many batches are made of equally long utterances at once, and of so many times fewer
utterances are those in Whisper's own 30 s.
"""
WHOLE_SHARE, PROMPT_SHARE = 0.05, 0.75
ROWS_AFTER = (10, 200)
"""So many rows of 10 ms follow what was heard."""
_WHOLE_ROWS = 3_000
UNWANTED, AS_TAUGHT = -1, -2
OF_A_BABBLE = 40
"""So many clips are in it."""


class Batch(NamedTuple):
    """What is said (sounds, samples), of so many samples each; how many rows of bands are wanted;
    tokens (sounds, tokens), and what follows each: a token, `UNWANTED`, or `AS_TAUGHT` where it is
    what Whisper makes of the clean sound.
    """

    tracks: torch.Tensor
    sizes: torch.Tensor
    rows: int
    tokens: torch.Tensor
    follow: torch.Tensor


class Batches(IterableDataset[Batch]):
    """Batches of these clips without end, for the model in this folder."""

    def __init__(self, folder: Path, clips: Sequence[Clip], size: int, seed: int) -> None:
        self._tokenizer_file = str(folder / "tokenizer.json")
        self._clips, self._size, self._seed = clips, size, seed

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        seed = self._seed + (worker.id if worker else 0)
        maker = _Maker(tokens_of(self._tokenizer_file), self._size, seed)
        utterances = Utterances(self._clips, seed)
        while True:
            yield from maker.of(utterances)


def babble(clips: Sequence[Clip], number: int) -> torch.Tensor:
    """The babble of this number, (samples,): natural voices of these clips that talk at once."""
    natural = [clip for clip in clips if clip.engine == "kokoro"]
    some = random.Random(number).choices(natural, k=OF_A_BABBLE)
    return torch.from_numpy(Utterances(some, number).babble())


class _Maker:
    """Makes batches of this size."""

    def __init__(self, words: Tokenizer, size: int, seed: int) -> None:
        self._tokenizer, self._size = words, size
        self._rng, self._drawn = np.random.default_rng((seed, 1)), random.Random(seed)

    def of(self, utterances: Utterances) -> Iterator[Batch]:
        """Some, in no order."""
        made = sorted(
            (utterances.make() for _ in range(self._size * OF_A_KIND)),
            key=lambda one: one.track.size,
        )
        for at in self._rng.permutation(OF_A_KIND) * self._size:
            some = made[at : at + self._size]
            if self._rng.random() < WHOLE_SHARE:
                yield self._batch(some[: self._size // WHOLE], _WHOLE_ROWS)
            rows = some[-1].track.size // HOP_SAMPLES + int(self._rng.integers(*ROWS_AFTER))
            yield self._batch(some, min(rows + rows % 2, _WHOLE_ROWS))

    def _batch(self, some: Sequence[Utterance], rows: int) -> Batch:
        words = self._tokenizer
        pairs = [self._tokens(one.text) for one in some]
        longest = max(len(before) + len(of_text) for before, of_text in pairs) - 1
        tokens = np.full((len(some), longest), words.eot)
        follow = np.full((len(some), longest), UNWANTED)
        for row, (one, (before, of_text)) in enumerate(zip(some, pairs, strict=True)):
            whole = [*before, *of_text]
            tokens[row, : len(whole) - 1] = whole[:-1]
            follow[row, len(before) - 1 : len(whole) - 1] = of_text
            follow[row, len(before) - 2] = AS_TAUGHT if one.text else words.no_speech
        return Batch(
            pad_sequence([torch.from_numpy(one.track) for one in some], batch_first=True).half(),
            torch.tensor([one.track.size for one in some]),
            rows,
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


def tokens_of(file: str) -> Tokenizer:
    """Whisper's tokens of English."""
    return Tokenizer(Words.from_file(file), False, task="transcribe", language="en")
