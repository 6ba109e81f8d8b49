"""Takes a trained network into the package, where one asks for it: nothing else writes there."""

from io import BytesIO
from pathlib import Path

import numpy as np
from whisper_training.whole_file import write_whole

from edgevox.voice.stop_encoder import CHANNELS, STEPS
from edgevox.voice.stop_network import StopWeights, likelihoods, weights_of


class NotInstalled(Exception):
    """The file is not one to install; the message says why."""


def install(trained: Path, place: Path, threshold: float) -> StopWeights:
    """Write the trained network to its place with this threshold, whole or not at all.

    Raises `NotInstalled`.
    """
    if not 0 < threshold < 1:
        raise NotInstalled(f"threshold: {threshold} is not between 0 and 1")
    try:
        with np.load(BytesIO(trained.read_bytes())) as data:
            arrays = {**data, "threshold": np.float64(threshold)}
        weights = weights_of(arrays)
    except FileNotFoundError:
        raise NotInstalled(f"{trained} is not there: train first") from None
    except (ValueError, KeyError, EOFError) as error:
        raise NotInstalled(f"{trained} is no file of the spotter: {error}") from error
    _check(trained, weights)
    write_whole(place, lambda out: np.savez(out, **arrays))
    return weights


def _check(trained: Path, weights: StopWeights) -> None:
    """That it runs."""
    found = likelihoods(weights, np.zeros((1, STEPS, CHANNELS), np.float32))
    if not np.all(np.isfinite(found)):
        raise NotInstalled(f"{trained}: what it says of silence is no number")
