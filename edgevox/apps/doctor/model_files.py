"""The check of the models that the settings need: whether they are here, and intact."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from edgevox.apps.agent.queries import fetch_commands
from edgevox.apps.agent.voice import needed_models
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, warning
from edgevox.apps.robots import ROBOTS
from edgevox.core.languages import LANGUAGES
from edgevox.core.settings import NO_LLM
from edgevox.models import Store
from edgevox.models.manifest import Model, ModelFile
from edgevox.models.store import has_right_bytes, is_whole

ABSENT, DAMAGED, RIGHT = "absent", "damaged", "right"
_READERS = 2


def needed(situation: Situation) -> Iterator[str]:
    """The ids of the models without which EdgeVox would not start, or not hear."""
    settings = situation.settings
    if settings.llm != NO_LLM and not settings.llm.endswith(".gguf"):
        yield settings.llm
    if not settings.text_mode:
        yield LANGUAGES[settings.language].stt_model
        yield from needed_models(settings)
    if situation.agent in ROBOTS:
        yield from ROBOTS[situation.agent].models


def wanted(situation: Situation) -> Iterator[str]:
    """Yield the models without which it would speak worse."""
    if not situation.settings.text_mode:
        yield from LANGUAGES[situation.settings.language].voices[0].models


def probe_models(situation: Situation) -> Facts:
    """List the wanted models, and the state of those and of all that are here."""
    store = Store()
    must = list(dict.fromkeys(needed(situation)))
    better = [one for one in dict.fromkeys(wanted(situation)) if one not in must]
    here = [name for name, one in store.manifest.models.items() if store.folder(one).is_dir()]
    asked = [*must, *better]
    with ThreadPoolExecutor(_READERS, thread_name_prefix="hash") as pool:
        states = pool.map(lambda name: _state(store, name, quick=situation.quick), asked)
        found = dict(zip(asked, states, strict=True))
    found |= {name: _state(store, name, quick=True) for name in here if name not in found}
    unknown = [name for name in must if name not in store.manifest.models]
    file = situation.settings.llm if situation.settings.llm.endswith(".gguf") else ""
    return {
        "root": str(store.root),
        "needed": must,
        "wanted": better,
        "found": found,
        "unknown": unknown,
        "file": file if file and not Path(file).is_file() else "",
    }


def judge_models(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    """Judge the models: a faulty needed one is an error, a faulty optional one a warning."""
    found, unknown = facts["found"], facts["unknown"]
    said = [error(f"{name}: no such model", "edgevox-models list shows all") for name in unknown]
    if facts["file"]:
        said.append(error(f"{facts['file']}: no such file", "correct llm"))
    for grade, names in ((error, facts["needed"]), (warning, facts["wanted"])):
        wrong = [name for name in names if found[name] != RIGHT and name not in unknown]
        said += [grade(f"{name} is {found[name]}", _fetch(name, found[name])) for name in wrong]
    asked = {*facts["needed"], *facts["wanted"]}
    others = [name for name, state in found.items() if name not in asked and state == DAMAGED]
    said += [
        warning(f"{name}, not needed now, is damaged", _fetch(name, DAMAGED)) for name in others
    ]
    right = sum(state == RIGHT for state in found.values())
    how = "by size and stamp" if situation.quick else "those needed hashed"
    summary = f"{right} of {len(found)} here and right, {how}, in {facts['root']}"
    return [*said, ok(summary)] if right or not said else said


def _state(store: Store, name: str, *, quick: bool) -> str:
    """A file that is there and wrong is damaged, also where others are absent."""
    model = store.manifest.models.get(name)
    if model is None:
        return ABSENT
    states = {_file_state(store, model, file, quick=quick) for file in model.files}
    return next(state for state in (DAMAGED, ABSENT, RIGHT) if state in states)


def _file_state(store: Store, model: Model, file: ModelFile, *, quick: bool) -> str:
    folder = store.folder(model)
    path = folder / file.name
    if not path.is_file():
        return ABSENT
    right = is_whole(folder, file) if quick else has_right_bytes(path, file)
    return RIGHT if right else DAMAGED


def _fetch(name: str, state: str = ABSENT) -> str:
    command = next(iter(fetch_commands([name])), f"edgevox-models fetch {name}")
    return command if state == ABSENT else f"edgevox-models verify {name}; {command}"
