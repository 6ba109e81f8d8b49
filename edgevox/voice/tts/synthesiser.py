"""The interface of a speech synthesiser, and what synthesisers share."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.process import usable_cpus
from edgevox.voice.audio import Chunk, Samples

if TYPE_CHECKING:
    from onnxruntime import InferenceSession


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


def open_session(path: Path, threads: int, *, arena: bool = True) -> "InferenceSession":
    """Load an ONNX model on the CPU with this many threads, and no more than may compute at once.

    A thread that spins while it waits takes the core that another thread needs. Without the
    `arena`, memory is given back after each run, and not kept for the largest run so far.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = min(threads, usable_cpus())
    options.inter_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.log_severity_level = 3
    options.enable_cpu_mem_arena = arena
    return onnxruntime.InferenceSession(
        str(path), sess_options=options, providers=["CPUExecutionProvider"]
    )
