"""What sources share: staging of half-fetched files, and tools that run without a terminal.

No tool runs for ever. The simplest source is here, too: a `Folder` that somebody brought, such as
that of a bundle.
"""

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import FolderSource, ModelFile
from edgevox.models.model_errors import SourceFailed
from edgevox.models.store import has_right_bytes

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


class Folder:
    """Copies a model's files, all or none: one that is wrong keeps the others away, too."""

    def provide(
        self, spec: FolderSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        wrong = [one.name for one in files if not has_right_bytes(spec.folder / one.name, one)]
        if wrong:
            raise SourceFailed(f"{', '.join(wrong)} is missing or damaged")
        done = 0
        for file in files:
            place = place_for(file, staging)
            shutil.copyfile(spec.folder / file.name, place)
            yield file, place
            progress.at(done := done + file.size)
