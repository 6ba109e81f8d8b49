"""What figures depend on: the machine, the versions, the commit, and what else ran there."""

import os
import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from benchmarks import ROOT
from benchmarks.core.figures import Kept
from edgevox import __version__

LIBRARIES = (
    "ctranslate2",
    "faster-whisper",
    "ir-sim",
    "kokoro-onnx",
    "llama-cpp-python",
    "mujoco",
    "numpy",
    "onnxruntime",
    "piper-tts",
    "pymunk",
    "ros-jazzy-rclpy",
    "ros-jazzy-rmw-fastrtps-cpp",
    "xllamacpp",
)
"""What does the work that is measured."""
RENDERED = ("README.md", "docs/figures.md", "docs/images", "benchmarks/*.json")
"""What a run of the benchmarks changes itself."""


class Machine(Kept):
    """What it is, without its name."""

    processor: str
    cores: int
    memory_gb: int
    system: str
    kernel: str
    architecture: str

    def __str__(self) -> str:
        cores = "1 core" if self.cores == 1 else f"{self.cores} cores"
        return (
            f"{self.processor}, {cores}, {self.memory_gb} GB, {self.system}, "
            f"Linux {self.kernel}, {self.architecture}"
        )


class Environment(Kept):
    """The machine and the versions."""

    machine: Machine
    versions: dict[str, str]


def environment() -> Environment:
    """Where this runs."""
    return Environment(machine=_machine(), versions=_versions())


def commit() -> tuple[str, bool]:
    """The commit's short hash, empty outside a checkout, and whether the code was changed since."""
    try:
        name = _git("rev-parse", "--short=10", "HEAD").strip()
        skipped = [f":(exclude){path}" for path in RENDERED]
        return name, bool(_git("status", "--porcelain", "--", ".", *skipped).strip())
    except (OSError, subprocess.CalledProcessError):
        return "", True


def load() -> float:
    """How many programs wanted a core in the last minute."""
    return round(os.getloadavg()[0], 2)


def _machine() -> Machine:
    info = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    processor = next(
        (x.split(":")[1].strip() for x in info.splitlines() if x.startswith("model name")), "?"
    )
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return Machine(
        processor=processor,
        cores=len(os.sched_getaffinity(0)),
        memory_gb=round(memory / 2**30),
        system=_system(),
        kernel=".".join(platform.release().split("-")[0].split(".")[:2]),
        architecture=platform.machine(),
    )


def _system() -> str:
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def _versions() -> dict[str, str]:
    found = {"edgevox": __version__, "python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _git(*arguments: str) -> str:
    command = ("git", "-C", str(ROOT), *arguments)
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout
