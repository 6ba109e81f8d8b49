"""The choice of a voice: the one that was asked for, else the best one that this machine has.

`installed` tells whether a voice's engine is here without loading anything. `VoicePool` holds the
voices that are loaded.
"""

import shutil
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.languages import LANGUAGES, Language, Voice
from edgevox.voice.tts.espeak import COMMAND, EspeakSynthesiser, open_espeak
from edgevox.voice.tts.synthesiser import Synthesiser

PACKAGES = {
    "piper": ("piper",),
    "kokoro": ("kokoro_onnx",),
    "kokoro-j": ("kokoro_onnx", "pykakasi"),
    "kokoro-z": ("kokoro_onnx", "misaki", "jieba", "pypinyin", "cn2an"),
}
"""Packages that a backend needs. Kokoro's Japanese and Chinese voices, by their first letter,
need more: espeak-ng, which makes the phonemes of the other languages, cannot read their script."""


SERVER = "server"
"""The backend of a voice that is on no machine of ours (`edgevox.voice.remote`)."""


def installed(voice: Voice) -> bool:
    """Return whether everything but the voice's model is installed."""
    if voice.backend == "espeak":
        return _has("espeakng_loader") or shutil.which(COMMAND) is not None
    special = f"{voice.backend}-{voice.key[0]}"
    return all(_has(name) for name in PACKAGES.get(special, PACKAGES[voice.backend]))


@cache
def _has(package: str) -> bool:
    return find_spec(package) is not None


Find = Callable[[str], Path | None]
"""Returns the entry file of an edgevox-models model, by its id; None if it is not here."""
Installed = Callable[[Voice], bool]
"""Returns whether a voice's engine is installed here."""


@dataclass(frozen=True, slots=True)
class VoiceChoice:
    """A voice of a language with the files it needs (`Voice.models`), ready to be loaded."""

    language: str
    voice: Voice
    files: tuple[Path, ...] = ()

    @property
    def name(self) -> str:
        return self.voice.name

    @property
    def backend(self) -> str:
        return self.voice.backend


def available(
    language: Language, find: Find, installed: Installed = installed
) -> tuple[VoiceChoice, ...]:
    """The voices of a language that can speak on this machine now, best first."""
    return tuple(
        VoiceChoice(language.code, voice, files)
        for voice in language.voices
        if installed(voice) and (files := _files(voice, find)) is not None
    )


def choose(
    language: str, voice: str, find: Find, installed: Installed = installed
) -> tuple[VoiceChoice, ...]:
    """Return the voices to try, in order.

    The named voice comes first, or the language's best if the name is empty. Fallbacks follow: the
    best voice of every other backend, in the language's order. The last is espeak-ng. Raises
    `InvalidValue`.
    """
    if language not in LANGUAGES:
        raise InvalidValue("language", language, "one of " + ", ".join(LANGUAGES))
    here = available(LANGUAGES[language], find, installed)
    first = next((one for one in here if voice in ("", one.name)), None)
    if first is None:
        names = ", ".join(one.name for one in here) or "nothing: no speech engine is installed"
        raise InvalidValue("voice", voice, f"for the language {language} one of {names}")
    return (first, *_fallbacks(here, first))


class PresentVoices:
    """The voices to speak with at this moment, looked up before every sentence.

    A voice that was found once stays first until another is asked for, even if its files go away:
    it is loaded by then. A voice that was never here is replaced by the language's best. `wanted`
    returns language and voice, `finder` a fresh `Find`.
    """

    def __init__(self, wanted: Callable[[], tuple[str, str]], finder: Callable[[], Find]) -> None:
        self._wanted = wanted
        self._finder = finder
        self._found: dict[tuple[str, str], VoiceChoice] = {}

    def __call__(self) -> Sequence[VoiceChoice]:
        """The voice, and after it those to be tried; none if nothing here speaks the language."""
        wanted = language, voice = self._wanted()
        here = available(LANGUAGES[language], self._finder())
        asked = next((one for one in here if voice in ("", one.name)), None)
        known = self._found.get(wanted)
        if known and known not in here:
            return (known, *_fallbacks(here, known))
        first = asked or next(iter(here), None)
        if first is None:
            return ()
        self._found[wanted] = first
        return (first, *_fallbacks(here, first))


def _fallbacks(here: Sequence[VoiceChoice], first: VoiceChoice) -> list[VoiceChoice]:
    best: dict[str, VoiceChoice] = {first.backend: first}
    for choice in here:
        best.setdefault(choice.backend, choice)
    return [choice for choice in best.values() if choice is not first]


def _files(voice: Voice, find: Find) -> tuple[Path, ...] | None:
    found = tuple(path for model in voice.models if (path := find(model)))
    return found if len(found) == len(voice.models) else None


if TYPE_CHECKING:
    from edgevox.voice.tts.kokoro import KokoroModel

MOST_LOADED = 4
"""A Piper voice takes about 150 MB; a user who changes back and forth should not wait for
loading."""


class VoicePool:
    """Loads voices on demand and keeps the ones that were used last.

    Used from one thread. Kokoro's voices share one model, espeak-ng's one library. `server` opens a
    server's voice.
    """

    def __init__(
        self,
        most: int = MOST_LOADED,
        server: Callable[[VoiceChoice], Synthesiser] | None = None,
    ) -> None:
        self._most = most
        self._server = server
        self._loaded: OrderedDict[VoiceChoice, Synthesiser] = OrderedDict()
        self.files: frozenset[Path] = frozenset()
        """Files of the voices that are loaded. May be read from any thread."""

    def get(self, choice: VoiceChoice) -> Synthesiser:
        """The voice, loaded and warm. Raises `EdgeVoxError` if it cannot be loaded."""
        found = self._loaded.pop(choice, None)
        if found is None:
            try:
                found = self._load(choice)
                found.warm_up()
            except Exception as error:  # its libraries raise whatever they like for a file
                raise EdgeVoxError(f"voice {choice.name}: cannot load it: {error}") from error
        self._loaded[choice] = found
        while len(self._loaded) > self._most:
            self._loaded.popitem(last=False)
        self.files = frozenset(file for one in self._loaded for file in one.files)
        return found

    def _load(self, choice: VoiceChoice) -> Synthesiser:
        if choice.backend == SERVER and self._server:
            return self._server(choice)
        match choice.backend, choice.files:
            case "piper", (model,):
                from edgevox.voice.tts.piper import PiperSynthesiser

                return PiperSynthesiser(model)
            case "kokoro", (model, voices):
                from edgevox.voice.tts.kokoro import KokoroSynthesiser, load_style

                return KokoroSynthesiser(self._kokoro(model), load_style(voices, choice.voice.key))
            case _:
                return EspeakSynthesiser(open_espeak(), choice.voice.key)

    def _kokoro(self, path: Path) -> "KokoroModel":
        from edgevox.voice.tts.kokoro import KokoroModel, KokoroSynthesiser

        for voice in self._loaded.values():
            if isinstance(voice, KokoroSynthesiser) and voice.model.path == path:
                return voice.model
        return KokoroModel(path)
