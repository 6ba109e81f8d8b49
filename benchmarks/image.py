"""What the container's image weighs and how fast it comes up. Writes `image.md` beside itself.

``python benchmarks/image.py`` needs an engine and the image, and its stages in the engine's build
cache: what rebuilding costs is measured by rebuilding.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(ROOT / "tests" / "compose"))

from machine import machine  # noqa: E402
from stacks import Stack, docker, stack  # noqa: E402

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
Row = tuple[str, str]


def sizes(image: str) -> list[Row]:
    """Megabytes by part, from the engine's history of the image."""
    form = "--format={{json .}}"
    lines = docker("history", "--no-trunc", "--human=false", form, image).splitlines()
    total = dict.fromkeys((*PARTS, "the rest"), 0)
    for layer in map(json.loads, lines):
        text = f"{layer['CreatedBy']} {layer['Comment']}"
        part = next((name for name, sign in PARTS.items() if sign.search(text)), "the rest")
        total[part] += int(layer["Size"])
    rows = [(name, f"{size / 1e6:,.0f}") for name, size in total.items() if size > 50_000]
    return [*rows, ("**all**", f"{sum(total.values()) / 1e6:,.0f}")]


def starting_and_answering() -> list[Row]:
    """Seconds from `docker compose up`, and memory at rest and while the model answers."""
    began = time.monotonic()
    with stack(EDGEVOX_IMAGE=IMAGE) as one:
        ready_s = time.monotonic() - began
        answered_s = ask(one, COMMAND)
        rest = memory(one)
        model_s = ask(one, QUESTION)
        return [
            ("`docker compose up` to ready, s", f"{ready_s:.1f}"),
            ("a plain command to its answer, with a peer's discovery, s", f"{answered_s:.1f}"),
            ("the first sentence for the model to its answer, likewise, s", f"{model_s:.1f}"),
            ("memory at rest, without mapped weights, MB", f"{rest:,.0f}"),
            ("the same after answering with the model, MB", f"{memory(one):,.0f}"),
        ]


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


def rebuilding() -> Row:
    """Seconds to build the image again after a change of the code, in a copy of it."""
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place) / "edgevox"
        skipped = shutil.ignore_patterns(".*", "__pycache__", "build", "dist")
        shutil.copytree(ROOT, copy, ignore=skipped)
        shutil.copy(ROOT / ".dockerignore", copy)
        environment = {**os.environ, "TAG": "rebuilt"}
        for attempt in range(2):  # the first may miss the cache
            with (copy / "edgevox" / "apps" / "agent.py").open("a") as code:
                code.write(f"# {attempt} {time.time()}\n")
            began = time.monotonic()
            command = [copy / "docker" / "image", "edgevox"]
            subprocess.run(command, env=environment, check=True, capture_output=True)
            took_s = time.monotonic() - began
    docker("image", "rm", "edgevox-ros2:rebuilt")
    return "rebuilding after a change of the code, s", f"{took_s:.1f}"


def table(head: Row, rows: list[Row]) -> str:
    """Markdown."""
    lines = [f"| {name} | {value} |" for name, value in (head, *rows)]
    return "\n".join([lines[0], "|---|---:|", *lines[1:]])


def main() -> int:
    """Measure, print, write."""
    slim = f"{IMAGE}-slim"
    parts = [
        f"# What the container's image costs\n\nMeasured on {machine()}.",
        f"## Size of `{IMAGE}`\n\n{table(('part', 'MB'), sizes(IMAGE))}",
        f"## Size of `{slim}`\n\n{table(('part', 'MB'), sizes(slim))}",
        f"## Time and memory\n\n{table(('what', ''), [*starting_and_answering(), rebuilding()])}",
    ]
    text = "\n\n".join(parts) + "\n"
    (HERE / "image.md").write_text(text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
