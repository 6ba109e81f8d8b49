"""Train the adapter of the sentence encoder, and the regressions that tell kinds of sentences.

The encoder's publisher taught it what a text is about. Here its upper layers learn what a robot is
asked to do or to tell, and how that is meant: to each array of theirs two narrow matrices are added
(LoRA), and learn together with the regressions on the features. Both go to
`edgevox/agent/nlu/head.npz`; `train.py` then has to learn the rest of that file again.

    python -m training.decision.adapter [--held-out]

With `--held-out` every tenth sentence is kept apart, and only how well it is told is printed.
Needs PyTorch; takes half an hour on two cores.
"""

import argparse
import random
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional as nnf

from edgevox.agent.nlu.encoder import ENCODER, LAYERS, Encoder, Floats, Packed
from edgevox.models import locate
from training.decision.kinds import FIRST, all_kinds, is_apart, write_head
from training.whisper.course import Course
from training.whisper.encoder import Adapted

LOWEST, RANK = 3, 16
"""The first layer that learns, and the width of what is added."""
EPOCHS, AT_ONCE = 6, 64
FASTEST, OF_HEADS, SLOWEST = 1.5e-3, 3e-3, 0.02
DROPPED, SMOOTHED = 0.1, 0.05
_LIKE_LONG = 20
"""Number of batches whose sentences are put together by their length."""


class Row(NamedTuple):
    """A sentence, and the kind that it is of in one regression."""

    says: str
    head: str
    kind: int


class Layer(nn.Module):
    """One layer of the encoder, values (sentences, tokens, hidden), with what is added to it."""

    def __init__(self, packed: Packed, number: int) -> None:
        super().__init__()
        sizes, self._epsilon = packed.sizes, packed.epsilon
        self._heads, self._dropped = sizes.heads, nn.Dropout(DROPPED)
        columns = dict.fromkeys(("q", "k", "v", "ao", "fi"), sizes.hidden) | {"fo": sizes.inner}
        self.names = [f"l{number}.{part}" for part in columns]
        self.adapted = nn.ModuleList(
            Adapted(
                torch.from_numpy(packed.matrix(f"{name}.w", count)),
                torch.from_numpy(packed.floats(f"{name}.b")),
                RANK,
            )
            for name, count in zip(self.names, columns.values(), strict=True)
        )
        for part in ("alnw", "alnb", "olnw", "olnb"):
            held = packed.floats(f"l{number}.{part[:-1]}.{part[-1]}")
            self.register_buffer(part, torch.from_numpy(held), persistent=False)

    def forward(self, values: torch.Tensor, said: torch.Tensor) -> torch.Tensor:
        """`said` (sentences, tokens) is False behind a sentence's end."""
        *three, out, widen, narrow = self.adapted
        parted = [one(values).unflatten(2, (self._heads, -1)).transpose(1, 2) for one in three]
        taken = nnf.scaled_dot_product_attention(*parted, attn_mask=said[:, None, None])
        values = self._normed("aln", values + self._dropped(out(taken.transpose(1, 2).flatten(2))))
        return self._normed("oln", values + self._dropped(narrow(nnf.gelu(widen(values)))))

    def _normed(self, part: str, values: torch.Tensor) -> torch.Tensor:
        weights, bias = self.get_buffer(f"{part}w"), self.get_buffer(f"{part}b")
        return nnf.layer_norm(values, weights.shape, weights, bias, self._epsilon)


class Network(nn.Module):
    """The upper layers, and the regressions on their features."""

    def __init__(self, packed: Packed, kinds: dict[str, list[str]]) -> None:
        super().__init__()
        self.layers = nn.ModuleList(Layer(packed, number) for number in range(LOWEST, LAYERS))
        size = 2 * packed.sizes.hidden
        self.heads = nn.ModuleDict({name: nn.Linear(size, len(k)) for name, k in kinds.items()})
        for one in self.heads.values():
            nn.init.zeros_(one.weight)
        self.register_buffer("middle", torch.zeros(size))
        self.register_buffer("spread", torch.ones(size))

    def forward(self, values: torch.Tensor, said: torch.Tensor) -> torch.Tensor:
        """The features (sentences, size), as `Encoder.features`, but each of the same spread."""
        for layer in self.layers[:-1]:
            values = layer(values, said)
        last = self.layers[-1](values, said) * said[..., None]
        means = last.sum(1) / said.sum(1)[:, None]
        largest = values.masked_fill(~said[..., None], -torch.inf).amax(1)
        return (torch.cat([means, largest], 1) - self.middle) / self.spread


class Training:
    """The network, and the values of each sentence below its first layer."""

    def __init__(self, rows: Sequence[Row], kinds: dict[str, list[str]]) -> None:
        encoder = Encoder(locate(ENCODER), adapter={})
        self._kinds, self._network = kinds, Network(Packed(locate(ENCODER)), kinds)
        self._below: dict[str, NDArray[np.float16]] = {}
        for one in rows:
            if one.says not in self._below:
                below = encoder.tokens(one.says, layers=LOWEST)
                self._below[one.says] = below.astype(np.float16)

    def learn(self, rows: Sequence[Row], folder: Path) -> None:
        """Until all epochs are done."""
        features = self.features(rows)
        self._network.middle.copy_(features.mean(0))
        self._network.spread.copy_(features.std(0) + 1e-6)
        steps = EPOCHS * -(-len(rows) // AT_ONCE)
        parts = {self._network.layers: FASTEST, self._network.heads: OF_HEADS}
        course = Course(self._network, parts, folder / "learning.pt", steps, SLOWEST)
        lost = 0.0
        for _ in range(EPOCHS):
            for batch in self._batches(rows):
                loss = self._loss(batch)
                course.step(loss)
                lost += loss.item()
                if course.done % 100 == 0:
                    print(f"{course.done} of {steps}: {lost / 100:.3f}", flush=True)
                    lost = 0.0

    def _batches(self, rows: Sequence[Row]) -> Iterator[Sequence[Row]]:
        """All rows in a new order, those of a like length together."""
        mixed = random.sample(rows, len(rows))
        batches: list[Sequence[Row]] = []
        for at in range(0, len(mixed), AT_ONCE * _LIKE_LONG):
            some = sorted(mixed[at : at + AT_ONCE * _LIKE_LONG], key=self._length)
            batches += [some[i : i + AT_ONCE] for i in range(0, len(some), AT_ONCE)]
        yield from random.sample(batches, len(batches))

    def _length(self, row: Row) -> int:
        return len(self._below[row.says])

    def _loss(self, rows: Sequence[Row]) -> torch.Tensor:
        features = nnf.dropout(self._network.train()(*self._inputs(rows)), DROPPED)
        losses = []
        for name, head in self._network.heads.items():
            chosen = [at for at, one in enumerate(rows) if one.head == name]
            if chosen:
                wanted = torch.tensor([rows[at].kind for at in chosen])
                scores = head(features[chosen])
                loss = nnf.cross_entropy(scores, wanted, label_smoothing=SMOOTHED, reduction="sum")
                losses.append(loss)
        return torch.stack(losses).sum() / len(rows)

    def _inputs(self, rows: Sequence[Row]) -> tuple[torch.Tensor, torch.Tensor]:
        several = [torch.from_numpy(self._below[one.says]).float() for one in rows]
        said = [torch.ones(len(one), dtype=torch.bool) for one in several]
        padded = nn.utils.rnn.pad_sequence
        return padded(several, batch_first=True), padded(said, batch_first=True)

    def features(self, rows: Sequence[Row]) -> torch.Tensor:
        """Features of each row, shape (rows, size)."""
        self._network.eval()
        found = torch.zeros(len(rows), len(self._network.middle))
        order = sorted(range(len(rows)), key=lambda at: self._length(rows[at]))
        with torch.no_grad():
            for at in range(0, len(order), AT_ONCE):
                some = order[at : at + AT_ONCE]
                found[some] = self._network(*self._inputs([rows[i] for i in some]))
        return found

    def report(self, rows: Sequence[Row]) -> None:
        """Print how many of these sentences are told rightly, and how many surely."""
        features = self.features(rows)
        for name, head in self._network.heads.items():
            chosen = [at for at, one in enumerate(rows) if one.head == name]
            wanted = torch.tensor([rows[at].kind for at in chosen])
            with torch.no_grad():
                likely, told = head(features[chosen]).softmax(1).max(1)
            right, sure = (told == wanted).float(), likely > 0.9
            print(
                f"{name}: {right.mean():.1%} right; above 0.9 {sure.float().mean():.1%},"
                f" of which {right[sure].mean():.1%} right; {len(chosen)} sentences"
            )

    def arrays(self) -> Iterator[tuple[str, object]]:
        """What it has learnt, with the names of the head's file."""
        for layer in self._network.layers:
            for name, one in zip(layer.names, layer.adapted, strict=True):
                for end, half in one.named(name):
                    yield end, half.astype(np.float16)
        middle, spread = self._network.middle.numpy(), self._network.spread.numpy()
        for name, head in self._network.heads.items():
            weights: Floats = head.weight.detach().numpy() / spread
            yield f"{name}_kinds", np.array(self._kinds[name])
            yield f"{name}_weights", weights
            yield f"{name}_biases", head.bias.detach().numpy() - weights @ middle


def main() -> int:
    """Train; write what was learnt, or print how well what was kept apart is told."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--held-out", action="store_true", help="keep every tenth sentence apart")
    options = parser.parse_args()
    torch.manual_seed(7)
    random.seed(7)
    of = all_kinds()
    kinds = {
        name: list(dict.fromkeys([FIRST[name], *(kind for _, kind in rows)]))
        for name, rows in of.items()
    }
    rows = [
        Row(says, name, kinds[name].index(kind)) for name, some in of.items() for says, kind in some
    ]
    training = Training(rows, kinds)
    learnt = [one for one in rows if not (options.held_out and is_apart(one.says))]
    with tempfile.TemporaryDirectory() as folder:
        training.learn(learnt, Path(folder))
    if options.held_out:
        training.report([one for one in rows if is_apart(one.says)])
    else:
        write_head(dict(training.arrays()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
