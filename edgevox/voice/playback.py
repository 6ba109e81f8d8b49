"""Playing a chunk so that what was heard of it is known to a tenth of a second."""

import numpy as np

from edgevox.voice.audio import AudioSink, Chunk, Samples
from edgevox.voice.utterance import SpeakingUtterance

PIECE_S = 0.1
_QUIET = 300
"""About a hundredth of full scale: softer than that, nobody hears it."""


def play_chunk(chunk: Chunk, line: int, utterance: SpeakingUtterance, sink: AudioSink) -> None:
    """Play it in pieces until it is over or cut, and note down what was played."""
    size = max(1, int(PIECE_S * chunk.rate_hz))
    for at in range(0, len(chunk.samples), size):
        if utterance.token.cancelled:
            return
        piece = Chunk(chunk.samples[at : at + size], chunk.rate_hz)
        start_s = sink.play(piece, utterance.token)
        utterance.log.played(line, len(piece.samples) / chunk.rate_hz)
        if len(loud := loud_at(piece.samples)):
            utterance.audible(start_s + float(loud[0]) / chunk.rate_hz)


def silent_end_s(chunk: Chunk) -> float:
    """How many seconds of silence it ends with."""
    loud = loud_at(chunk.samples)
    speech = int(loud[-1]) + 1 if len(loud) else 0
    return (len(chunk.samples) - speech) / chunk.rate_hz


def loud_at(samples: Samples) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Where it can be heard, shape (n,), indices."""
    return np.flatnonzero(np.abs(samples.astype(np.int32)) > _QUIET)
