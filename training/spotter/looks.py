"""What is learnt from: looks at examples in all languages, made anew by as many processes as asked.

A look at an example in another language is judged twice: by the words of that language, and by the
English ones, which count there, too.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch.utils.data import IterableDataset, get_worker_info

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stop_spotter.network import SAMPLES
from training.spotter.examples import IGNORED, Example, Examples, Sound
from training.spotter.languages import ENGLISH, Outputs

OF_A_BLOCK = 128
"""So many examples come together."""
ENGLISH_SHARE = 0.6
"""Of the examples; each other language has as many as the next."""


class Block(NamedTuple):
    """Of some examples: what is said (examples, samples); of each look which example it is at, and
    at which sample it ends; and of each which output it is to find: in the language, and in
    English, `IGNORED` where nothing is to be judged.
    """

    tracks: torch.Tensor
    at: torch.Tensor
    ends: torch.Tensor
    own: torch.Tensor
    english: torch.Tensor

    def looks(self, heard: torch.Tensor) -> torch.Tensor:
        """What each look sees of what is `heard` of the tracks: (looks, `SAMPLES`)."""
        places = self.ends[:, None] + torch.arange(-SAMPLES, 0, device=self.ends.device)
        return heard[self.at[:, None], places]


class Looks(IterableDataset[Block]):
    """Blocks without end, of the sounds of each language; of the English words as many as `shares`
    say.
    """

    def __init__(
        self,
        sounds: Mapping[str, Sequence[Sound]],
        outputs: Outputs,
        seed: int,
        shares: Sequence[float] | None = None,
    ) -> None:
        self._sounds, self._outputs, self._seed = sounds, outputs, seed
        self._shares = shares

    def __iter__(self) -> Iterator[Block]:
        worker = get_worker_info()
        rng = np.random.default_rng((self._seed, worker.id if worker else 0))
        examples = {
            code: Examples(some, rng, self._shares if code == ENGLISH else None)
            for code, some in self._sounds.items()
        }
        languages = [*examples]
        odds = shares_of(languages)
        while True:
            drawn = (languages[n] for n in rng.choice(len(languages), OF_A_BLOCK, p=odds))
            yield self._block([(one, examples[one].make()) for one in drawn], rng)

    def _block(self, some: Sequence[tuple[str, Example]], rng: np.random.Generator) -> Block:
        found: list[tuple[int, int, int, int]] = []
        for number, (language, example) in enumerate(some):
            for when in example.times(rng):
                label = example.label(when)
                own, english = self._outputs.wanted(language, label)
                if (own, english) != (IGNORED, IGNORED):
                    end = min(int(when * RATE_HZ), example.track.size)
                    found.append((number, end, own, english))
        tracks = np.stack([example.track for _, example in some]).astype(np.float16)
        return Block(torch.from_numpy(tracks), *torch.tensor(found).unbind(1))


def shares_of(languages: Sequence[str]) -> np.ndarray:
    """How many of the examples are of each language."""
    other = (1 - ENGLISH_SHARE) / max(1, len(languages) - 1)
    odds = np.array([ENGLISH_SHARE if one == ENGLISH else other for one in languages])
    return odds / odds.sum()
