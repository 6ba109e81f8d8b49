"""The voices that are loaded."""

from collections import OrderedDict
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox.core.errors import EdgeVoxError
from edgevox.voice.tts.synthesiser import Synthesiser
from edgevox.voice.tts.voices import VoiceChoice

if TYPE_CHECKING:
    from edgevox.voice.tts.kokoro import KokoroModel

MOST_LOADED = 4
"""A Piper voice takes about 150 MB; a user who changes back and forth should not wait for
loading."""


class VoicePool:
    """Loads voices on demand and keeps the ones that were used last.

    Used from one thread. Kokoro's voices share one model, espeak-ng's one library.
    """

    def __init__(self, most: int = MOST_LOADED) -> None:
        self._most = most
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
        match choice.backend, choice.files:
            case "piper", (model,):
                from edgevox.voice.tts.piper import PiperSynthesiser

                return PiperSynthesiser(model)
            case "kokoro", (model, voices):
                from edgevox.voice.tts.kokoro import KokoroSynthesiser, load_style

                return KokoroSynthesiser(self._kokoro(model), load_style(voices, choice.voice.key))
            case _:
                from edgevox.voice.tts.espeak import EspeakSynthesiser, open_espeak

                return EspeakSynthesiser(open_espeak(), choice.voice.key)

    def _kokoro(self, path: Path) -> "KokoroModel":
        from edgevox.voice.tts.kokoro import KokoroModel, KokoroSynthesiser

        for voice in self._loaded.values():
            if isinstance(voice, KokoroSynthesiser) and voice.model.path == path:
                return voice.model
        return KokoroModel(path)
