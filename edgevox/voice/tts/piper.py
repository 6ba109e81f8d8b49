"""Piper: one small model a voice, quick on one core."""

import json
from collections.abc import Iterator
from pathlib import Path

from piper import PiperVoice
from piper.config import PiperConfig

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.synthesiser import open_session, to_samples

THREADS = 1
"""Speech is ten times faster than real time on one thread. There is no memory arena: with sounds
of random length, an arena grew by 80 MB now and then. Without it, synthesis is a tenth slower
and takes 70 MB less."""


class PiperSynthesiser:
    """A Piper voice: `model` is its ``.onnx`` file, with the ``.onnx.json`` beside it."""

    phrase_chars = 90

    def __init__(self, model: Path, threads: int = THREADS) -> None:
        config = PiperConfig.from_dict(json.loads(Path(f"{model}.json").read_text("utf-8")))
        session = open_session(model, threads, arena=False)
        self._voice = PiperVoice(session=session, config=config)
        self.sample_rate_hz: int = config.sample_rate

    def warm_up(self) -> None:
        for _ in self.synthesise("Hello.", CancelToken()):
            pass

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        pieces = iter(self._voice.synthesize(sentence))
        while not token.cancelled:
            piece = next(pieces, None)
            if piece is None:
                return
            yield Chunk(to_samples(piece.audio_float_array), piece.sample_rate)
