"""The network of the stop word spotter, in NumPy: the likelihood that each word was just said.

It takes the output of Whisper's encoder for the last 1.1 s of sound. Two convolutions over time
follow, then four weighted means over time and the mean of the last 0.16 s, and from those the
likelihoods.

Whisper's smallest English network was trained on the speech of very many people in all kinds of
places; its encoder's output tells words apart in noise far better than features that can be learnt
from the voices here. It takes 3 to 4 ms for such a short sound. Whisper was not made for sounds so
short, so this network is trained on what the encoder makes of them.

The matrix products stay on the calling thread. NumPy's library spreads large ones over all cores;
where these are busy, it waits for them, and 0.2 ms become 50. Small ones it computes at once.
"""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import FULL_SCALE, Samples
from edgevox.voice.stt.adapter import Added, adapted_folder, added_of

MOST = 250_000
"""Multiplications together, about as many as OpenBLAS does not spread."""


def product(rows: NDArray[np.float32], matrix: NDArray[np.float32]) -> NDArray[np.float32]:
    """Multiply the rows (n, k), a few at a time, by a matrix (k, m): shape (n, m)."""
    found = np.empty((len(rows), matrix.shape[1]), np.float32)
    together = max(1, MOST // matrix.size)
    for first in range(0, len(rows), together):
        some = slice(first, first + together)
        np.matmul(rows[some], matrix, out=found[some])
    return found


Floats = NDArray[np.float32]

ENCODER = "whisper-tiny.en"
"""The model whose encoder it is, as the manifest names it."""
BANDS, WINDOW_SAMPLES, HOP_SAMPLES = 80, 400, 160
"""Whisper's own: 25 ms of sound every 10 ms."""
_ROWS = 112
SAMPLES = WINDOW_SAMPLES + (_ROWS - 1) * HOP_SAMPLES
"""The length of sound that the network looks at: 1.135 s at 16 kHz."""
STEPS, CHANNELS = _ROWS // 2, 384
"""The encoder's output for it: one step in 20 ms."""
RANGE = 8.0  # what is softer than the loudest by more than so many powers of ten is not heard
LOUDEST = 0.5  # how loud the loudest always is, in powers of ten
LEAST = 1e-10  # what is softer is as soft as this
_TAPER = np.hanning(WINDOW_SAMPLES + 1)[:-1].astype(np.float32)


def bands_of(sound: Samples) -> Floats:
    """Return the loudness of Whisper's bands in `SAMPLES` samples, shape (`BANDS`, rows).

    The loudest is always the same, so the loudness of the speaker does not matter.
    """
    scaled = sound.astype(np.float32) / FULL_SCALE
    windows = np.lib.stride_tricks.sliding_window_view(scaled, WINDOW_SAMPLES)[::HOP_SAMPLES]
    spectrum = np.fft.rfft(windows * _TAPER)
    power = (spectrum.real**2 + spectrum.imag**2).astype(np.float32)
    loudness = np.log10(np.maximum(product(power, _bands()), LEAST)).T
    beside = np.maximum(loudness - loudness.max(), -RANGE)
    return np.asarray((beside + LOUDEST + 4) / 4, np.float32)


@functools.cache
def _bands() -> Floats:
    """Return the weight of each frequency in each band, shape (frequencies, `BANDS`)."""
    from faster_whisper.feature_extractor import FeatureExtractor

    return np.ascontiguousarray(FeatureExtractor(feature_size=BANDS).mel_filters.T, np.float32)


class EncoderNotLoaded(EdgeVoxError):
    """Loading it failed; the message says why."""


class StopEncoder:
    """Whisper's encoder, from its folder, loaded at the first use.

    A failed load is not tried again: with a look every 64 ms it would do nothing else. `added` maps
    names of the encoder's arrays to what is added to Whisper's weights. It computes on one core,
    beside the transcribing engine: waiting for that engine would make it late.
    """

    def __init__(self, folder: Path, added: Mapping[str, Added]) -> None:
        self._folder = folder
        self._added = added

    def of(self, sounds: Sequence[Samples]) -> Floats:
        """Encode sounds of `SAMPLES` samples each, to shape (sounds, `STEPS`, `CHANNELS`).

        Raises `EncoderNotLoaded`.
        """
        import ctranslate2

        if isinstance(self._loaded, str):
            raise EncoderNotLoaded(self._loaded)

        bands = np.ascontiguousarray(np.stack([bands_of(sound) for sound in sounds]))
        encoded = self._loaded.encode(ctranslate2.StorageView.from_array(bands))
        return np.asarray(encoded, np.float32)

    @functools.cached_property
    def _loaded(self) -> Any:
        """The model, or in words why there is none."""
        import ctranslate2

        try:
            with adapted_folder(self._folder, self._added) as folder:
                return ctranslate2.models.Whisper(
                    str(folder), device="cpu", compute_type="int8",
                    inter_threads=1, intra_threads=1,
                )  # fmt: skip
        except Exception as error:  # noqa: BLE001 - whatever the library raises
            return f"{type(error).__name__}: {error}"


WEIGHTS_FILE = "stop_spotter.npz"
"""English, and what is added to the encoder; `training/spotter/train.py` makes both files."""
LANGUAGES_FILE = "stop_spotter_languages.npz"
"""The other languages, on the encoder of that."""
LAST_STEPS = 8
"""The last steps (0.16 s) whose mean is a feature of its own."""
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
    """The weights of the whole network."""

    words: tuple[str, ...]
    """The outputs' words; the first stands for no word."""
    scale: Floats
    """Of the norm over channels."""
    shift: Floats
    """Of the norm over channels."""
    place: Floats
    """Added to each step, so that the network can tell steps apart: shape (steps, channels)."""
    layers: Mapping[str, StopLayer]
    added: Mapping[str, Added]
    """What is added to the encoder's weights, by array name."""
    threshold: float
    """The likelihood from which a word counts as said."""


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
    """Read the other languages' weights, by ISO 639-1 code; from a file, else from the package.

    The languages share one network, with outputs of their own; nothing is added to the encoder for
    them.
    """
    return language_weights_of(_arrays(file, LANGUAGES_FILE))


def weights_of(data: Mapping[str, Any]) -> StopWeights:
    """Build the weights from their file's arrays, which are in half precision."""
    words = tuple(str(word) for word in data["words"])
    return _weights(data, words, added_of(data), float(data["threshold"]))


def language_weights_of(data: Mapping[str, Any]) -> dict[str, StopWeights]:
    """Build each language's weights from the arrays of their common file.

    They share the other layers.
    """
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
