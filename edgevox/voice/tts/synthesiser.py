"""The interface of a speech synthesiser."""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import Chunk, Samples


class SynthesisFailed(EdgeVoxError):
    """An engine gave no sound for a text that has words in it."""


class Synthesiser(Protocol):
    """A loaded voice. Used from one thread at a time."""

    sample_rate_hz: int
    phrase_chars: int
    """About how many characters to give it at once, so that its first sound is not late."""

    def warm_up(self) -> None:
        """Pay now for what the first sentence would have to wait for."""

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        """The sentence as sound, piece by piece; no further piece once the token is cancelled.

        Raises `SynthesisFailed`, or whatever the engine raises.
        """


def to_samples(sound: NDArray[np.float32]) -> Samples:
    """Convert sound from -1 to 1 to 16 bit samples; louder sound is clipped."""
    return (np.clip(sound, -1.0, 1.0) * np.iinfo(np.int16).max).astype(np.int16)
