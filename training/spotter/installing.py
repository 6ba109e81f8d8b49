"""Takes a trained network into the package, where one asks for it: nothing else writes there."""

import hashlib
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.stop_spotter.network import (
    CHANNELS,
    STEPS,
    StopWeights,
    language_weights_of,
    likelihoods,
    weights_of,
)
from edgevox.voice.stt.adapter import DOWN, UP
from training.whisper.program import write_whole

_OF_OUTPUTS = ("last", "last_bias", "words", "languages")
"""The arrays of the other languages whose last axis is that of all outputs."""


class NotInstalled(Exception):
    """The file is not one to install; the message says why."""


def install(trained: Path, place: Path, threshold: float) -> StopWeights:
    """Write the trained network to its place with this threshold, whole or not at all.

    Raises `NotInstalled`.
    """
    if not 0 < threshold < 1:
        raise NotInstalled(f"threshold: {threshold} is not between 0 and 1")
    arrays = {**_arrays(trained), "threshold": np.float64(threshold)}
    weights = weights_of(arrays)
    _check(trained, weights)
    write_whole(place, lambda out: np.savez(out, **arrays))
    return weights


def encoder_of(arrays: Mapping[str, NDArray[Any]]) -> str:
    """What tells apart what is added to the encoder, on which other languages are learnt; of the
    arrays of the English file.
    """
    digest = hashlib.sha256()
    for name in sorted(name for name in arrays if name.endswith((UP, DOWN))):
        digest.update(name.encode() + np.asarray(arrays[name], np.float16).tobytes())
    return digest.hexdigest()


def install_languages(trained: Path, place: Path, thresholds: Mapping[str, float]) -> None:
    """Write the trained network of the other languages to its place, whole or not at all.

    A language without a threshold is left out. Raises `NotInstalled`.
    """
    arrays = _read(trained)
    known = set(arrays["languages"])
    for language, threshold in thresholds.items():
        if language not in known:
            raise NotInstalled(f"{language}: {trained} knows {', '.join(sorted(known))}")
        if not 0 < threshold < 1:
            raise NotInstalled(f"threshold of {language}: {threshold} is not between 0 and 1")
    own = np.isin(arrays["languages"], list(thresholds))
    arrays |= {name: arrays[name][..., own] for name in _OF_OUTPUTS}
    arrays["thresholds"] = np.array([thresholds[code] for code in arrays["languages"]])
    for weights in language_weights_of(arrays).values():
        _check(trained, weights)
    write_whole(place, lambda out: np.savez(out, **arrays))


def _arrays(trained: Path) -> dict[str, NDArray[Any]]:
    arrays = _read(trained)
    try:
        weights_of(arrays)
    except KeyError as error:
        raise NotInstalled(f"{trained} is no file of the spotter: {error}") from error
    return arrays


def _read(trained: Path) -> dict[str, NDArray[Any]]:
    try:
        with np.load(BytesIO(trained.read_bytes())) as data:
            return {**data}
    except FileNotFoundError:
        raise NotInstalled(f"{trained} is not there: train first") from None
    except (ValueError, KeyError, EOFError) as error:
        raise NotInstalled(f"{trained} is no file of the spotter: {error}") from error


def _check(trained: Path, weights: StopWeights) -> None:
    """That it runs."""
    found = likelihoods(weights, np.zeros((1, STEPS, CHANNELS), np.float32))
    if not np.all(np.isfinite(found)):
        raise NotInstalled(f"{trained}: what it says of silence is no number")
