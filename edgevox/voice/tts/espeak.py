"""espeak-ng: plain, tiny, and at home in every language; what speaks when nothing better can.

`kana` converts Japanese script: espeak-ng says "Chinese letter" for other characters.
"""

import ctypes
import shutil
import subprocess
import threading
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.log import get_logger
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.synthesiser import SynthesisFailed
from edgevox.voice.wav import HEADER_BYTES

log = get_logger(__name__)

PACKAGE = "pykakasi"
_PARTICLES = {"は": "わ", "へ": "え", "を": "お"}  # as particles they sound otherwise


def kana(text: str) -> str:
    """The text in hiragana, a space between words. Unchanged without the package pykakasi."""
    if find_spec(PACKAGE) is None:
        return text
    return " ".join(_spoken(word["orig"], word["hira"]) for word in _reader().convert(text))


def _spoken(written: str, hiragana: str) -> str:
    if written in _PARTICLES:
        return _PARTICLES[written]
    if written.endswith("は") and len(written) > 1 and not _is_kana(written):
        return hiragana[:-1] + "わ"
    return hiragana


def _is_kana(text: str) -> bool:
    return all("ぁ" <= character <= "ん" for character in text)


@cache
def _reader() -> Any:
    """Load the reader; its dictionary takes half a second."""
    return import_module(PACKAGE).kakasi()


COMMAND = "espeak-ng"


class EspeakEngine(Protocol):
    """espeak-ng, however it is reached. May be used from any thread."""

    sample_rate_hz: int

    def speak(self, text: str, language: str, token: CancelToken) -> Chunk:
        """The text as sound; cut short once the token is cancelled. Raises `SynthesisFailed`."""


class EspeakSynthesiser:
    """A language of espeak-ng, by its name there (``en-us``, ``cmn``)."""

    phrase_chars = 400

    def __init__(self, engine: EspeakEngine, language: str) -> None:
        self._engine = engine
        self._language = language
        self.sample_rate_hz = engine.sample_rate_hz

    def warm_up(self) -> None:
        self._engine.speak("1", self._language, CancelToken())

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        if token.cancelled:
            return
        text = kana(sentence) if self._language == "ja" else sentence
        chunk = self._engine.speak(text, self._language, token)
        if len(chunk.samples) and not token.cancelled:
            yield chunk


def open_espeak() -> EspeakEngine:
    """The library of the espeakng-loader wheel, else the command on this machine.

    Raises `SynthesisFailed` if there is neither.
    """
    try:
        return espeak_library()
    except (ImportError, OSError, RuntimeError, SynthesisFailed) as error:
        log.info("espeak_library_missing", reason=str(error), instead=COMMAND)
    path = shutil.which(COMMAND)
    if path is None:
        raise SynthesisFailed(
            "espeak: there is no espeak-ng; expected the package espeakng-loader, "
            "or the command espeak-ng on PATH"
        )
    return EspeakCommand(path)


_RATE_HZ = 22_050  # of every voice of espeak-ng's own


class EspeakCommand:
    """The command ``espeak-ng``, by its path, where there is no library; one process a text."""

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


_SYNCHRONOUS = 2
_UTF8, _END_PAUSE = 0x1, 0x1000
_IPA = 0x2
_OK = 0
_Receive = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)


class EspeakLibrary:
    """The library, called in this process; its one state takes one text at a time."""

    def __init__(self) -> None:
        import espeakng_loader

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

    Raises `ImportError`, `OSError` or `SynthesisFailed` if it does not load.
    """
    with _loading:
        return _loaded()
