"""Running the tools that some sources need, without a terminal and never for ever.

Where half-fetched files are staged, apart from what the sources keep there.
"""

import os
import shutil
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from edgevox.models.manifest import ModelFile
from edgevox.models.model_errors import SourceFailed

_OF_NPM = ("npm error ", "npm ERR! ")
"""The beginning of its lines about a failure, in version 10 and before it."""


def place_for(file: ModelFile, staging: Path) -> Path:
    """A path for the file below the staging folder; its folder is there, the file may be."""
    path = staging / "files" / file.name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def run_tool(
    command: Sequence[str], *, where: Path, timeout_s: float, environment: Mapping[str, str]
) -> str:
    """What the tool printed. Raises `SourceFailed` if it is not installed, fails or takes too long.

    It runs in a process group of its own, which is gone when this returns or raises.
    """
    tool = shutil.which(command[0])
    if tool is None:
        raise SourceFailed(f"{command[0]} is not installed")
    with subprocess.Popen(
        [tool, *command[1:]],
        cwd=where,
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            printed, complained = process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            raise SourceFailed(f"{command[0]} took longer than {timeout_s:.0f} s") from None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
    if process.returncode != 0:
        raise SourceFailed(_reason(command[0], f"{printed}\n{complained}"))
    return printed


def _reason(name: str, said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    telling = [line for line in lines if line.startswith(("fatal:", "error:", *_OF_NPM))]
    chosen = telling[:2] or lines[-1:] or [f"{name} failed"]
    for prefix in _OF_NPM:
        chosen = [line.removeprefix(prefix) for line in chosen]
    return "; ".join(chosen)
