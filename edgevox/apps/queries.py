"""The answers to queries: true values of this machine and this process."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from edgevox.core.controls import Controls
from edgevox.core.languages import LANGUAGES
from edgevox.models import Store
from edgevox.ops.hardware import hardware_info

Queries = Mapping[str, Callable[[], Mapping[str, Any]]]
"""What can be asked, by name."""


def available_voices(language: str) -> Sequence[str]:
    """The voices of a language whose files are whole on this machine."""
    store = Store()
    known = {model.id: model for model in store.manifest.models.values()}
    found = ((voice, known.get(f"piper-{voice}")) for voice in LANGUAGES[language].voices)
    return [voice for voice, model in found if model and not store.missing(model)]


def build_queries(controls: Controls, llm_path: Path | None) -> Queries:
    """All queries of this process; `llm_path` is the language model that is loaded."""
    return {
        "list_voices": lambda: {
            "language": controls.language,
            "current_voice": controls.voice,
            "voices": list(controls.voices),
        },
        "list_languages": lambda: {"current": controls.language, "languages": _languages()},
        "hardware_info": hardware_info,
        "model_info": lambda: {
            "language": controls.language,
            "voice": controls.voice,
            "stt": _NO_STT,
            "llm": _llm(llm_path),
            "tts": {**_NO_TTS, "voice": controls.voice or None},
        },
    }


_NO_STT = {"backend": None, "model_size": None, "device": None}
_NO_TTS = {"backend": None, "sample_rate": None}


def _llm(path: Path | None) -> Mapping[str, Any]:
    return {"model_path": str(path) if path else None, "device": "cpu" if path else None}


def _languages() -> Mapping[str, Any]:
    return {
        code: {"name": one.name, "stt_backend": None, "tts_backend": None}
        for code, one in LANGUAGES.items()
    }
