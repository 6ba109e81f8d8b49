"""The answers to queries: true values of this machine and this process."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from edgevox.core.controls import Controls
from edgevox.core.errors import install_extra
from edgevox.core.languages import LANGUAGES, STT_BACKEND, Language
from edgevox.models import Store
from edgevox.ops.machine import hardware_info
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.tts.voices import PresentVoices, available, installed

Queries = Mapping[str, Callable[[], Mapping[str, Any]]]
"""Functions that answer queries, by name."""
Info = Callable[[], Mapping[str, Any]]

NO_STT = {"backend": None, "model_size": None, "device": None}
NO_TTS = {"backend": None, "voice": None, "sample_rate": None}


def find_model(model_id: str) -> Path | None:
    """Return a model's entry file; None if the model is incomplete here or unknown."""
    store = Store()
    model = store.manifest.models.get(model_id)
    if model is None or store.missing(model):
        return None
    return store.folder(model) / model.entry


def available_voices(language: str) -> Sequence[str]:
    """The voices of a language that can speak on this machine now, best first."""
    return [choice.name for choice in available(LANGUAGES[language], _Finder())]


def present_voices(wanted: Callable[[], tuple[str, str]]) -> PresentVoices:
    """Gives what speaks now by language and voice, and after it what is tried when it fails."""
    return PresentVoices(wanted, _Finder)


def deafness(language: str) -> str:
    """Return the reason why this language cannot be heard here; empty if it can."""
    model = LANGUAGES[language].stt_model
    commands = [] if find_model(model) else fetch_commands([model])
    return f"{model} is not here: {commands[0]}" if commands else ""


def build_queries(
    controls: Controls,
    llm_path: Path | None,
    *,
    endpoint: str = "",
    stt: Info = lambda: NO_STT,
    tts: Info = lambda: NO_TTS,
    programs: Info = lambda: {"programs": []},
) -> Queries:
    """All queries of this process.

    `llm_path` is the language model that is loaded, `endpoint` the server that is asked before it;
    `stt` and `tts` say what hears and speaks, `programs` which orders wait and run.
    """
    return {
        "list_voices": lambda: {
            "language": controls.language,
            "current_voice": controls.voice,
            "voices": list(controls.voices),
        },
        "list_languages": lambda: {"current": controls.language, "languages": list_languages()},
        "hardware_info": hardware_info,
        "model_info": lambda: {
            "language": controls.language,
            "voice": controls.voice,
            "stt": stt(),
            "llm": _llm(llm_path, endpoint),
            "tts": tts(),
        },
        "list_programs": programs,
    }


def tts_info(synthesiser: SentenceSynthesiser) -> Mapping[str, Any]:
    """Return the synthesiser's part of `model_info`: the voice that spoke last or is ready."""
    if synthesiser.last is None:
        return NO_TTS
    choice, rate_hz = synthesiser.last
    return {"backend": choice.backend, "voice": choice.name, "sample_rate": rate_hz}


def list_languages() -> Mapping[str, Any]:
    """Return, for every language, its engines on this machine and the commands that fetch the rest.

    `missing` are those commands. A language without a better voice is spoken by espeak-ng.
    """
    find = _Finder()
    return {code: _language(one, find) for code, one in LANGUAGES.items()}


def _language(language: Language, find: Callable[[str], Path | None]) -> Mapping[str, Any]:
    hears = find(language.stt_model) is not None
    voices = available(language, find)
    wanted = [] if hears else [language.stt_model]
    if all(choice.backend == "espeak" for choice in voices):
        wanted += [model for model in language.voices[0].models if find(model) is None]
    return {
        "name": language.name,
        "stt_backend": STT_BACKEND if hears else None,
        "tts_backend": voices[0].backend if voices else None,
        "missing": fetch_commands(wanted) + _packages(language),
    }


def _packages(language: Language) -> list[str]:
    """Return the command that installs the engine of a language's best voice, if it is missing."""
    return [] if installed(language.voices[0]) else [install_extra("voice")]


def fetch_commands(model_ids: Iterable[str]) -> list[str]:
    """Return the commands that fetch these models: a set that has them, else the model itself."""
    manifest = Store().manifest
    commands = {}
    for model_id in model_ids:
        sets = (name for name, members in manifest.sets.items() if model_id in members)
        commands[f"edgevox-models fetch {next(sets, model_id)}"] = model_id in manifest.models
    return [command for command, known in commands.items() if known]


class _Finder:
    """`find_model`, each file looked up once: thirty voices may need the same one."""

    def __init__(self) -> None:
        self._found: dict[str, Path | None] = {}

    def __call__(self, model_id: str) -> Path | None:
        if model_id not in self._found:
            self._found[model_id] = find_model(model_id)
        return self._found[model_id]


def _llm(path: Path | None, endpoint: str) -> Mapping[str, Any]:
    found = {"model_path": str(path) if path else None, "device": "cpu" if path else None}
    return found | ({"endpoint": endpoint} if endpoint else {})
