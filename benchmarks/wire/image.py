"""The size of the container's image, and how fast it comes up.

Needs an engine, the image, and its stages in the engine's build cache.
"""

import json
import os
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from stacks import Stack, docker, stack

from benchmarks import ROOT
from benchmarks.core.figures import Figure, Measured, NotHere

SERVICE = "edgevox-ros2"
IMAGE = os.environ.get("EDGEVOX_IMAGE", "edgevox-ros2:local")
QUESTION = "I am so tired, I could fall asleep right here"  # for the language model
COMMAND = "where are you?"  # for a template
BASE_LAYER = re.compile(r"Imported from|/opt/ros/jazzy /opt|COPY /system|/docker/base/|docker/base")
PARTS = {  # what a layer is, by the instruction that made it; the first that matches
    "the base: Debian, Python, NumPy, ROS 2": BASE_LAYER,
    "models": re.compile(r"COPY /opt/edgevox/models"),
    "ROS 2 interfaces": re.compile(r"COPY /opt/edgevox/ros"),
    "Python packages": re.compile(r"COPY /opt/edgevox /opt/edgevox"),
    "Mesa, to draw without a GPU": re.compile(r"libgl1-mesa-dri"),
    "EdgeVox": re.compile(r"COPY /code"),
    "bill of materials": re.compile(r"sbom"),
}
_NOT_WORDS = re.compile(r"[^a-z0-9]+")
ALL = "all"
WANTED_MB = {"image": 2000.0, "slim": 700.0}
SIZES = "What the image holds"
TIMES = "Time and memory of the container"


def measure(quick: bool = False) -> Measured:
    """The sizes of both images; how the larger starts, and how long a change takes to be in it."""
    slim = f"{IMAGE}-slim"
    for image in (IMAGE, slim):
        _refuse_unless_here(image)
    builds = 1 if quick else 2  # the first may miss the cache
    return Measured(
        figures=(
            *sizes("image", IMAGE),
            *sizes("slim", slim),
            *starting_and_answering(),
            _time("rebuild", "rebuilding after a change of the code", rebuilding(builds), 15),
        )
    )


def _refuse_unless_here(image: str) -> None:
    command = ["docker", "image", "inspect", image]
    try:
        found = subprocess.run(command, check=False, capture_output=True, text=True)
    except OSError as error:
        raise NotHere(f"docker: {error}") from error
    if found.returncode:
        raise NotHere(f"{image}: {found.stderr.strip()}; make image builds it")


def sizes(name: str, image: str) -> Iterator[Figure]:
    """Megabytes by part, from the engine's history of the image."""
    form = "--format={{json .}}"
    lines = docker("history", "--no-trunc", "--human=false", form, image).splitlines()
    total = dict.fromkeys((*PARTS, "the rest"), 0)
    for layer in map(json.loads, lines):
        text = f"{layer['CreatedBy']} {layer['Comment']}"
        part = next((part for part, sign in PARTS.items() if sign.search(text)), "the rest")
        total[part] += int(layer["Size"])
    column = "with models and robots" if name == "image" else "slim"
    for part, size in {**total, ALL: sum(total.values())}.items():
        if size > 50_000:
            yield Figure.of(
                f"{name}.{_NOT_WORDS.sub('_', part.lower())}", SIZES, part, [size / 1e6], "MB",
                column=column, wanted=WANTED_MB[name] if part == ALL else None,
            )  # fmt: skip


def starting_and_answering() -> Iterator[Figure]:
    """Seconds from `docker compose up`, and memory at rest and while the model answers."""
    began = time.monotonic()
    with stack(EDGEVOX_IMAGE=IMAGE) as one:
        yield _time("ready", "`docker compose up` to ready", time.monotonic() - began, 15)
        answered_s = ask(one, COMMAND)
        yield _time("answer", "a plain command to its answer, with a peer's discovery", answered_s)
        rest = memory(one)
        model_s = ask(one, QUESTION)
        yield _time("model", "the first sentence for the model to its answer, likewise", model_s)
        yield _memory("memory_rest", "memory at rest, without mapped weights", rest)
        yield _memory("memory_model", "the same after answering with the model", memory(one))


def _time(name: str, what: str, seconds: float, wanted: float | None = None) -> Figure:
    return Figure.of(name, TIMES, what, [seconds], "s", wanted=wanted)


def _memory(name: str, what: str, megabytes: float) -> Figure:
    return Figure.of(name, TIMES, what, [megabytes], "MB")


def ask(one: Stack, words: str) -> float:
    """Seconds until what was said was answered."""
    began = time.monotonic()
    heard = one.probe(SERVICE, "60", "/edgevox/response=", "--say", f"/edgevox/text_input={words}")
    if not heard["found"]["/edgevox/response"]:
        raise RuntimeError(f"no answer to {words!r}: {heard}")
    return time.monotonic() - began


def memory(one: Stack) -> float:
    """Megabytes that the container's processes have, as the engine counts."""
    identity = one.inspect(SERVICE)["Id"]
    used = docker("stats", "--no-stream", "--format={{.MemUsage}}", identity).split("/")[0].strip()
    number, unit = re.fullmatch(r"([\d.]+)([KMG]iB)", used).groups()
    return float(number) * {"KiB": 2**10, "MiB": 2**20, "GiB": 2**30}[unit] / 1e6


def rebuilding(times: int) -> float:
    """Seconds to build the image again after a change of the code, in a copy of it."""
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place) / "edgevox"
        skipped = shutil.ignore_patterns(".*", "__pycache__", "build", "dist")
        shutil.copytree(ROOT, copy, ignore=skipped)
        shutil.copy(ROOT / ".dockerignore", copy)
        environment = {**os.environ, "TAG": "rebuilt"}
        for attempt in range(times):
            with (copy / "edgevox" / "apps" / "agent.py").open("a", encoding="utf-8") as code:
                code.write(f"# {attempt} {time.time()}\n")
            began = time.monotonic()
            command = [copy / "docker" / "image", "edgevox"]
            built = subprocess.run(
                command, env=environment, check=False, capture_output=True, text=True
            )
            if built.returncode:
                raise RuntimeError(f"docker/image edgevox: {built.stderr[-2000:]}")
            took_s = time.monotonic() - began
    docker("image", "rm", "edgevox-ros2:rebuilt")
    return took_s
