"""The network of the other languages: one for all, of which each language has its own outputs.

It stands on the encoder of the package's weights, as that has learnt English in noise. Who speaks a
language is judged by its outputs alone, of which the first is for none of its words.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import torch
from acoustics.languages import words
from numpy.typing import NDArray
from torch.nn.functional import cross_entropy
from whisper_training.whole_file import write_whole

from edgevox.voice.stop_network import read_weights
from stop_spotter.installing import encoder_of
from stop_spotter.looks import Looks
from stop_spotter.network import Network, layers_of
from stop_spotter.training import THRESHOLD, learnt

INNER = 128
"""More than the English one has: it knows seven times as many words."""


class Outputs:
    """Which output is of which language and word; a look's label is the number of its output."""

    def __init__(self, languages: Sequence[str]) -> None:
        named = [(code, word) for code in languages for word in ("", *words(code))]
        self.languages = [code for code, _ in named]
        self.words = [word for _, word in named]
        codes = list(dict.fromkeys(self.languages))
        numbers = torch.tensor([codes.index(code) for code in self.languages])
        self._others = numbers[:, None] != numbers[None, :]

    def __len__(self) -> int:
        return len(self.words)

    def first(self, language: str) -> int:
        """That for none of its words."""
        return self.languages.index(language)

    def loss(self, scores: torch.Tensor, labels: torch.Tensor) -> torch.Tensor:
        """Of scores (looks, outputs): those of other languages do not count."""
        return cross_entropy(scores.masked_fill(self._others[labels], -torch.inf), labels)


def fit_languages(
    looks: Mapping[str, Looks], steps: int, file: Path, told: Callable[[str], None]
) -> None:
    """Learn from the looks of each language, labelled as in it alone; write what was learnt to its
    file.
    """
    outputs = Outputs(list(looks))
    drawn = []
    for language, one in looks.items():
        labels = (one.labels + outputs.first(language)).astype(np.int8)
        drawn.append((Looks(one.seen, labels), 1))
    network = Network(INNER, outputs=len(outputs))
    learnt(network, drawn, steps, outputs.loss, told, seed=len(drawn))
    arrays = arrays_of_languages(network.eval(), outputs)
    write_whole(file, lambda out: np.savez(out, **arrays))


def arrays_of_languages(network: Network, outputs: Outputs) -> dict[str, NDArray]:
    """What `edgevox/voice/stop_network.py` reads; each language has the threshold to begin with."""
    return layers_of(network) | {
        "words": np.array(outputs.words),
        "languages": np.array(outputs.languages),
        "thresholds": np.full(len(outputs), THRESHOLD),
        "encoder": np.array(encoder_of(read_weights())),
    }
