"""The network of the stop word spotter, as it runs, in NumPy: how likely each word was just said.

It takes what Whisper's encoder makes of the last second. Two convolutions over time follow, then
four weighted means over time and the mean of the last 0.16 s, and of those the likelihoods.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.one_thread import product
from edgevox.voice.stop_encoder import Floats
from edgevox.voice.whisper_file import Added, added_of

WEIGHTS_FILE = "stop_spotter.npz"
"""English, and what is added to the encoder; `training/spotter/train.py` makes both files."""
LANGUAGES_FILE = "stop_spotter_languages.npz"
"""The other languages, on the encoder of that."""
LAST_STEPS = 8
"""So many steps at the end are looked at by themselves, too."""
_LEAST_VARIANCE = 1e-5
_LAYERS = ("reduce", "first", "second", "attend", "hidden", "last")


@dataclass(frozen=True, slots=True)
class StopLayer:
    """`weights` (inputs, outputs) and `bias` (outputs); of a convolution its taps are inputs."""

    weights: Floats
    bias: Floats

    def of(self, values: Floats) -> Floats:
        found = product(values.reshape(-1, values.shape[-1]), self.weights) + self.bias
        return np.asarray(found.reshape(*values.shape[:-1], -1))


@dataclass(frozen=True, slots=True)
class StopWeights:
    """Of the whole network; `words` are its outputs, the first one for none.

    `scale` and `shift` belong to the norm over channels, `place` (steps, channels) tells steps
    apart. `added` is what the encoder's arrays are to be more than Whisper's, by their names. From
    `threshold` on, a word counts as said.
    """

    words: tuple[str, ...]
    scale: Floats
    shift: Floats
    place: Floats
    layers: Mapping[str, StopLayer]
    added: Mapping[str, Added]
    threshold: float


def likelihoods(known: StopWeights, encoded: Floats) -> Floats:
    """Shape (sounds, words), of what the encoder made of them (sounds, steps, channels)."""
    layers = known.layers
    values = np.maximum(layers["reduce"].of(_normed(known, encoded)), 0) + known.place
    for name in ("first", "second"):
        values = values + np.maximum(layers[name].of(_beside(values)), 0)
    looked_at = _softmax(layers["attend"].of(values), axis=1)
    means = np.einsum("nsk,nsc->nkc", looked_at, values).reshape(len(values), -1)
    whole = np.concatenate([means, values[:, -LAST_STEPS:].mean(axis=1)], axis=1)
    hidden = np.maximum(layers["hidden"].of(whole), 0)
    return _softmax(layers["last"].of(hidden), axis=1)


def _normed(known: StopWeights, encoded: Floats) -> Floats:
    """Each step with a mean of 0 and a variance of 1 over its channels, then scaled."""
    middle = encoded - encoded.mean(axis=2, keepdims=True)
    spread = np.sqrt(np.mean(middle**2, axis=2, keepdims=True) + _LEAST_VARIANCE)
    return np.asarray(middle / spread * known.scale + known.shift)


def _beside(values: Floats) -> Floats:
    """Each step with the one before and the one after it; there are zeros around them."""
    wide = np.pad(values, ((0, 0), (1, 1), (0, 0)))
    return np.concatenate([wide[:, :-2], wide[:, 1:-1], wide[:, 2:]], axis=2)


def _softmax(scores: Floats, axis: int) -> Floats:
    grown = np.exp(scores - scores.max(axis=axis, keepdims=True))
    return np.asarray(grown / grown.sum(axis=axis, keepdims=True), np.float32)


def read_weights(file: Path | None = None) -> StopWeights:
    """The English ones of a file, else those that this package brings."""
    return weights_of(_arrays(file, WEIGHTS_FILE))


def read_language_weights(file: Path | None = None) -> dict[str, StopWeights]:
    """Those of the other languages, by their ISO 639-1 codes; of a file, else the package's.

    They are of one network, of which each language has its own outputs; nothing is added to the
    encoder for them.
    """
    return language_weights_of(_arrays(file, LANGUAGES_FILE))


def weights_of(data: Mapping[str, Any]) -> StopWeights:
    """From the arrays of their file, which keeps them in half precision."""
    words = tuple(str(word) for word in data["words"])
    return _weights(data, words, added_of(data), float(data["threshold"]))


def language_weights_of(data: Mapping[str, Any]) -> dict[str, StopWeights]:
    """Those of each language, from the arrays of the file of all; they share what is not theirs."""
    words = tuple(str(word) for word in data["words"])
    whole = _weights(data, words, {}, 0.0)
    last = whole.layers["last"]
    found = {}
    for language in np.unique(data["languages"]):
        own = np.flatnonzero(data["languages"] == language)
        outputs = StopLayer(np.ascontiguousarray(last.weights[:, own]), last.bias[own])
        found[str(language)] = replace(
            whole,
            words=tuple(words[at] for at in own),
            layers={**whole.layers, "last": outputs},
            threshold=float(data["thresholds"][own[0]]),
        )
    return found


def _weights(
    data: Mapping[str, Any], words: tuple[str, ...], added: Mapping[str, Added], threshold: float
) -> StopWeights:
    def floats(name: str) -> Floats:
        return np.asarray(data[name], np.float32)

    layers = {name: StopLayer(floats(name), floats(f"{name}_bias")) for name in _LAYERS}
    place = floats("place")
    return StopWeights(words, floats("scale"), floats("shift"), place, layers, added, threshold)


def _arrays(file: Path | None, name: str) -> dict[str, NDArray[Any]]:
    held = (file or files(__package__).joinpath(name)).read_bytes()
    with np.load(BytesIO(held)) as data:
        return {**data}
