"""The checks of the machine and of this process.

Python, processor, memory, disks, clock, GPU, OpenGL without a display; settings, folders that must
be writable, container; the models that the settings need: whether they are here, and intact; and
what a program that runs here says of itself.
"""

import http.client
import json
import os
import platform
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from edgevox import __version__
from edgevox.agent.llm import weights
from edgevox.agent.llm.factory import XLLAMACPP_NEEDS, missing_features
from edgevox.agent.llm.weights import needed_bytes, read_memory
from edgevox.apps.agent.models import chosen_llm, find_weights
from edgevox.apps.agent.queries import fetch_commands
from edgevox.apps.agent.voice import needed_models
from edgevox.apps.container.environment import warn_of_unknown
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.apps.folders import needed_folders, ros_logs, written_folders
from edgevox.apps.health import TIMEOUT_S, ask, reachable
from edgevox.apps.robots import ROBOTS
from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.core.languages import LANGUAGES
from edgevox.core.process import cpu_quota, usable_cpus
from edgevox.core.settings import NO_LLM, Settings
from edgevox.core.status import ComponentName, Level
from edgevox.models import Store
from edgevox.models.manifest import Model, ModelFile
from edgevox.models.store import has_right_bytes, is_whole
from edgevox.ops.machine import (
    MIB,
    NEVER_SET_BEFORE_S,
    DiskSpace,
    room,
    rooms,
    synchronised,
    unwritable,
)

_WITH_CAMERA = ("robot-panda", "robot-humanoid")


def probe_gpu() -> Facts:
    """Look for GPUs; in its own process, since a broken driver may do anything."""
    import pynvml

    try:
        pynvml.nvmlInit()
        count = pynvml.nvmlDeviceGetCount()
        handles = [pynvml.nvmlDeviceGetHandleByIndex(index) for index in range(count)]
        names = [str(pynvml.nvmlDeviceGetName(one)) for one in handles]
    except pynvml.NVMLError_LibraryNotFound:
        return {"names": [], "failed": ""}
    except pynvml.NVMLError as failed:
        return {"names": [], "failed": str(failed)}
    return {"names": names, "failed": ""}


def judge_gpu(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge the GPU: no GPU is fine; a broken driver is not."""
    if facts["failed"]:
        advice = "install the kernel module and the library in the same version, then restart"
        return warning(f"NVIDIA's driver does not answer: {facts['failed']}", advice)
    if facts["names"]:
        return ok(", ".join(facts["names"]))
    return ok("none, and none is needed")


def probe_egl() -> Facts:
    """Draw a picture; in its own process, since a driver may end it."""
    from edgevox.robots.mujoco import gl

    try:
        gl.shield_import()
    except ImportError:
        return {"backend": gl.backend(), "failed": "", "installed": False}
    try:
        gl.open_context(64, 64).free()
    except gl.NoPicture as failed:
        return {"backend": gl.backend(), "failed": str(failed), "installed": True}
    return {"backend": gl.backend(), "failed": "", "installed": True}


def judge_egl(facts: Facts, situation: Situation) -> CheckVerdict:
    """Judge EGL: without it, only pictures are missing."""
    if not facts["installed"]:
        return skipped("MuJoCo is not installed", f"{install_extra('mujoco')} brings two robots")
    if facts["failed"]:
        advice = "sudo apt install libegl1 libgl1 libgl1-mesa-dri"
        sees = situation.agent in _WITH_CAMERA
        return warning(facts["failed"], advice if sees else f"{advice} (for pictures only)")
    return ok(f"draws without a display, by {facts['backend']}")


PYTHONS = ((3, 11), (3, 12), (3, 13))
VOICE_MIB = 600
"""Speech recognition, voices and the rest, beside the language model."""
LEAST_CORES = 2


def probe_python(_: Situation) -> Facts:
    """The interpreter and the system."""
    return {
        "edgevox": __version__,
        "version": list(sys.version_info[:3]),
        "system": platform.system(),
        "release": platform.release(),
        "machine": platform.machine(),
    }


def judge_python(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge the Python version by the packages' builds."""
    version = ".".join(map(str, facts["version"]))
    system = f"{facts['system']} {facts['release']}, {facts['machine']}"
    found = f"EdgeVox {facts['edgevox']} with Python {version} on {system}"
    if tuple(facts["version"][:2]) not in PYTHONS:
        return error(found, "use Python 3.11, 3.12 or 3.13: make PYTHON=python3.12 ...")
    if facts["system"] != "Linux":
        return warning(found, "EdgeVox is made for Linux; try its container")
    return ok(found)


def probe_processor(_: Situation) -> Facts:
    """Cores, their limit, and features of x86-64 that are missing."""
    quota = cpu_quota()
    return {
        "cores": os.cpu_count() or 1,
        "usable": usable_cpus(),
        "quota": None if quota == float("inf") else quota,
        "missing": sorted(missing_features(XLLAMACPP_NEEDS)),
    }


def judge_processor(facts: Facts, situation: Situation) -> CheckVerdict:
    """Missing features end the process of the language model on board."""
    usable, cores = facts["usable"], facts["cores"]
    limit = f", limited to {facts['quota']:g} of them by a control group" if facts["quota"] else ""
    found = f"{usable} of {cores} cores{limit}"
    if missing := facts["missing"]:
        on_board = situation.settings.llm != NO_LLM and situation.settings.llm_backend != (
            "llama-cpp-python"
        )
        advice = "use --llm-backend llama-cpp-python, --llm-endpoint, or --llm none"
        grade = error if on_board else warning
        return grade(f"{found}; without {', '.join(missing)}", advice)
    if usable < LEAST_CORES:
        return warning(found, "give it two cores, or speech waits for the language model")
    return ok(f"{found}, enough for the models")


def probe_memory(situation: Situation) -> Facts:
    """MiB that there are, and what the language model that is asked for takes, as its loader says.

    Raises `OSError` where the kernel does not tell.
    """
    there = read_memory()
    if there is None:
        raise OSError("/proc/meminfo cannot be read")
    return {
        "total": there.total // MIB,
        "free": there.free // MIB,
        "limited_by": there.limited_by,
        "llm": _llm_bytes(situation.settings) // MIB,
    }


def judge_memory(facts: Facts, situation: Situation) -> CheckVerdict:
    """A language model that does not fit is refused at the start."""
    free, llm = facts["free"], facts["llm"]
    found = f"{free} MiB free of {facts['total']} MiB"
    if facts["limited_by"]:
        found += f" ({facts['limited_by']})"
    wanted = llm + (0 if situation.settings.text_mode else VOICE_MIB)
    if llm and free < llm:
        advice = "end other programs, choose a smaller --llm, --llm-endpoint, or --llm none"
        return error(f"{found}; the language model takes {llm} MiB", advice)
    if free < wanted:
        return warning(f"{found}; EdgeVox may take {wanted} MiB", "end other programs")
    return ok(found)


def probe_disk(situation: Situation) -> Facts:
    """The file systems that EdgeVox writes to."""
    folders = written_folders(situation.settings, situation.environment)
    return {
        "rooms": [
            [str(one.path), one.device, one.free, one.size, one.writable] for one in rooms(folders)
        ],
        "sealed": [
            str(one)
            for one in unwritable(needed_folders(situation.settings, situation.environment))
        ],
    }


def judge_disk(facts: Facts, _: Situation) -> list[CheckVerdict]:
    """Judge disks by the limits of /diagnostics."""
    said = []
    for path, *rest in facts["rooms"]:
        one = DiskSpace(Path(path), *rest)
        advice = f"free space in {path}" if one.level else ""
        said.append(CheckVerdict(one.level, f"{path}: {one.free // MIB} MiB free", advice))
    said += [
        warning(f"{path}: not writable, so nothing in it is kept", f"give {path} to this user")
        for path in facts["sealed"]
    ]
    return said or [ok("EdgeVox writes to no folder")]


def probe_clock(_: Situation) -> Facts:
    """The time, and whether the kernel believes it."""
    return {"now": time.time(), "synchronised": synchronised()}


def judge_clock(facts: Facts, _: Situation) -> CheckVerdict:
    """Other machines compare stamps with their own clocks."""
    when = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(facts["now"]))
    if facts["now"] < NEVER_SET_BEFORE_S:
        return error(f"it is {when}: the clock was never set", "set it: sudo timedatectl set-ntp 1")
    if facts["synchronised"] is False:
        advice = "time stamps of machines disagree: sudo timedatectl set-ntp 1"
        return warning(f"{when}, not synchronised", advice)
    known = "synchronised" if facts["synchronised"] else "synchronisation unknown"
    return ok(f"{when}, {known}")


def _llm_bytes(settings: Settings) -> int:
    """Return the bytes that the loader will need; for missing weights, without their context."""
    try:
        path = find_weights(settings)
        return needed_bytes(weights.check(path), settings.llm_context) if path else 0
    except EdgeVoxError:
        model = Store().manifest.models.get(chosen_llm(settings))
        return needed_bytes(weights.Weights(model.size, 0), settings.llm_context) if model else 0


def probe_settings(situation: Situation) -> Facts:
    """List the given variables, and the unknown ones among them."""
    unknown: list[str] = []
    warn_of_unknown(situation.environment, unknown.append)
    given = sorted(name for name in situation.environment if name.startswith("EDGEVOX_"))
    return {"given": given, "unknown": unknown}


def judge_settings(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    """Judge the settings: only here is a misspelled variable reported."""
    unknown = [warning(one, "correct or remove it") for one in facts["unknown"]]
    if situation.refused:
        advice = "correct it; the other checks used the defaults"
        return [error(situation.refused, advice), *unknown]
    count = len(facts["given"]) - len(unknown)
    return [*unknown, ok(f"valid; {count} from environment variables")]


def probe_folders(situation: Situation) -> Facts:
    """Test whether files can be made where they must be."""
    logs = ros_logs(situation.environment)
    return {
        "tmp": room(Path(tempfile.gettempdir())).writable,
        "logs": room(logs).writable,
        "at": str(logs),
    }


def judge_folders(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge the folders: a read-only root may lack a tmpfs."""
    if not facts["tmp"]:
        return error("no folder for temporary files", "mount a tmpfs at /tmp")
    if not facts["logs"]:
        advice = (
            "ROS 2 starts only where it can log: set ROS_LOG_DIR to a folder that can be written"
        )
        return warning(f"{facts['at']} cannot be written", advice)
    return ok("temporary files and ROS 2's logs can be written")


def probe_container(_: Situation) -> Facts:
    """Find out whether this is a container, and its user."""
    inside = Path("/.dockerenv").exists() or Path("/run/.containerenv").exists()
    return {
        "inside": inside or "KUBERNETES_SERVICE_HOST" in os.environ,
        "uid": os.getuid(),
        "read_only": bool(os.statvfs("/").f_flag & os.ST_RDONLY),
    }


def judge_container(facts: Facts, _: Situation) -> CheckVerdict:
    """Root in a container is more than a robot needs."""
    if not facts["inside"]:
        return skipped("not in a container")
    root = "read-only" if facts["read_only"] else "writable"
    found = f"uid {facts['uid']}, {root} root file system"
    if facts["uid"] == 0:
        return warning(found, "run it as its own user (uid 1000), as docker-compose.ros2.yml does")
    return ok(found)


ABSENT, DAMAGED, RIGHT = "absent", "damaged", "right"
_READERS = 2


def needed(situation: Situation) -> Iterator[str]:
    """The ids of the models without which EdgeVox would not start, or not hear."""
    settings = situation.settings
    llm = chosen_llm(settings)
    if llm != NO_LLM and not llm.endswith(".gguf"):
        yield llm
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


def probe_running(situation: Situation) -> Facts:
    """Ask the program on the health port of the settings how its components are."""
    host, port = situation.settings.health_host, situation.settings.health_port
    facts: Facts = {"port": port, "components": None}
    if port:
        try:
            text = ask(reachable(host), port, "/status", timeout_s=TIMEOUT_S)[1]
            told = [(str(o["name"]), Level(o["level"]), str(o["message"])) for o in _parts(text)]
        except (OSError, http.client.HTTPException, ValueError, KeyError, TypeError):
            return facts
        return {**facts, "components": told}
    return facts


def _parts(text: str) -> list[dict[str, Any]]:
    parts: list[dict[str, Any]] = json.loads(text)["components"]
    return parts


def judge_running(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """Judge a running program by what it says on /diagnostics."""
    if facts["components"] is None:
        why = f"nothing answers on port {facts['port']}" if facts["port"] else "no health_port"
        return skipped(why, "start the robot, then ask again")
    grades = {Level.WARN: warning, Level.ERROR: error}
    advice = 'docs/monitoring.md, "Diagnostics", says what to do'
    said = [
        grades[level](f"{name}: {message}", advice)
        for name, level, message in facts["components"]
        if level in grades and name != ComponentName.PROCESS  # it repeats the others
    ]
    return said or [ok(f"on port {facts['port']}, all of its components are well")]
