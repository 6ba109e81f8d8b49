"""espeak-ng as a command, for machines where the library is not to be had."""

import subprocess

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.synthesiser import SynthesisFailed
from edgevox.voice.wav import HEADER_BYTES

_RATE_HZ = 22_050  # of every voice of espeak-ng's own


class EspeakCommand:
    """The command ``espeak-ng``, by its path; one process a text."""

    sample_rate_hz = _RATE_HZ

    def __init__(self, path: str) -> None:
        self._path = path

    def speak(self, text: str, language: str, token: CancelToken) -> Chunk:
        arguments = [self._path, "-v", language, "-b", "1", "--stdin", "--stdout"]
        pipe = subprocess.PIPE
        with subprocess.Popen(arguments, stdin=pipe, stdout=pipe, stderr=pipe) as process:
            forget = token.on_cancel(process.kill)
            out, errors = process.communicate(text.encode())
            forget()
        if process.returncode and not token.cancelled:
            raise SynthesisFailed(f"espeak: {errors.decode(errors='replace').strip()}")
        whole = len(out) - (len(out) - HEADER_BYTES) % 2
        return Chunk(np.frombuffer(out[HEADER_BYTES:whole], np.int16), _RATE_HZ)
