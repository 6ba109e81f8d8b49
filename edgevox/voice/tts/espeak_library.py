"""espeak-ng as a library, called in this process."""

import ctypes
import threading
from functools import cache

import espeakng_loader
import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.synthesiser import SynthesisFailed

_SYNCHRONOUS = 2
_UTF8, _END_PAUSE = 0x1, 0x1000
_IPA = 0x2
_OK = 0
_Receive = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)


class EspeakLibrary:
    """The library's one state; one text at a time."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._library = ctypes.CDLL(espeakng_loader.get_library_path())
        data = espeakng_loader.get_data_path().encode()
        self.sample_rate_hz: int = self._library.espeak_Initialize(_SYNCHRONOUS, 0, data, 0)
        if self.sample_rate_hz <= 0:
            raise SynthesisFailed(f"espeak: the library finds no data in {data.decode()}")
        self._library.espeak_TextToPhonemes.restype = ctypes.c_char_p

    def speak(self, text: str, language: str, token: CancelToken) -> Chunk:
        pieces: list[bytes] = []

        def receive(samples: int | None, count: int, events: int | None) -> int:  # noqa: ARG001
            if samples and count:
                pieces.append(ctypes.string_at(samples, 2 * count))
            return int(token.cancelled)

        callback = _Receive(receive)
        data = text.replace("\0", " ").encode()
        with self._lock:
            self._set_language(language)
            self._library.espeak_SetSynthCallback(callback)
            flags = _UTF8 | _END_PAUSE
            self._library.espeak_Synth(
                data, ctypes.c_size_t(len(data) + 1), 0, 0, 0, flags, None, None
            )
        return Chunk(np.frombuffer(b"".join(pieces), np.int16), self.sample_rate_hz)

    def phonemes(self, text: str, language: str) -> str:
        """Return the text's pronunciation in letters of the IPA; takes some microseconds a word."""
        rest = ctypes.c_char_p(text.replace("\0", " ").encode())
        clauses: list[str] = []
        with self._lock:
            self._set_language(language)
            while rest.value:
                clause = self._library.espeak_TextToPhonemes(ctypes.byref(rest), _UTF8, _IPA)
                clauses.append((clause or b"").decode())
        return " ".join(clauses)

    def _set_language(self, language: str) -> None:
        if self._library.espeak_SetVoiceByName(language.encode()) != _OK:
            raise SynthesisFailed(f"espeak: it has no language {language!r}")


_loaded = cache(EspeakLibrary)
_loading = threading.Lock()


def espeak_library() -> EspeakLibrary:
    """The library; its state is global, so there is one in a process, whichever thread asks first.

    Raises `OSError` or `SynthesisFailed` if it does not load.
    """
    with _loading:
        return _loaded()
