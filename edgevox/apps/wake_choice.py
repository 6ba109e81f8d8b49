"""Which wake word listens, by which engine, and what its licence says."""

from collections.abc import Mapping
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.models.manifest import builtin_manifest
from edgevox.voice.wakeword import WakeDetector

log = get_logger(__name__)

MICRO = "micro-wake-words"
"""The id in edgevox-models of networks that a product may use."""
OPEN = "wake-words"
"""The id of openWakeWord's, which may not be used commercially."""
MODELS: Mapping[str, str] = {"micro": MICRO, "openwakeword": OPEN}
"""The models of each engine."""

_FRONT_END = {"embedding_model", "melspectrogram"}


def open_wakeword(settings: Settings) -> WakeDetector | None:
    """What listens for the wake word; None without one.

    Raises `InvalidValue` for a phrase that the engine has no network for, `ModelMissing` for
    networks that are not here.
    """
    if not settings.wakeword:
        return None
    if own := own_file(settings):
        return _micro(own)
    engine = settings.wakeword_engine
    phrase = " ".join(settings.wakeword.casefold().replace("_", " ").split())
    if phrase not in phrases(engine):
        others = [name for name in MODELS if phrase in phrases(name)]
        hint = f"; or set wakeword_engine to {others[0]}, which has it" if others else ""
        known = ", ".join(phrases(engine))
        raise InvalidValue("wakeword", settings.wakeword, f"one of {known}, or a .json file{hint}")
    folder = locate(MODELS[engine])
    if engine == "micro":
        return _micro(folder / f"{phrase.replace(' ', '_')}.json")
    from edgevox.voice.wakeword import WakeWord

    licence = builtin_manifest().licences[builtin_manifest().models[OPEN].licence]
    log.warning("wake_word_not_commercial", phrase=phrase, licence=licence.name)
    return WakeWord(phrase, folder)


def needed_models(settings: Settings) -> tuple[str, ...]:
    """The ids of the models that the wake word needs."""
    own = not settings.wakeword or own_file(settings)
    return () if own else (MODELS[settings.wakeword_engine],)


def phrases(engine: str) -> list[str]:
    """The wake words that an engine's models have."""
    names = (Path(file.name) for file in builtin_manifest().models[MODELS[engine]].files)
    stems = {name.stem for name in names if name.suffix == ".tflite"}
    return sorted(name.replace("_", " ") for name in stems - _FRONT_END)


def own_file(settings: Settings) -> Path | None:
    """The description of a network that somebody trained, if the setting names one."""
    file = Path(settings.wakeword).expanduser()
    return file if file.suffix == ".json" else None


def _micro(file: Path) -> WakeDetector:
    from edgevox.voice.microwakeword import MicroWakeWord

    return MicroWakeWord(file)
