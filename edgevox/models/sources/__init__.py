"""Places that models can be had from; one module a kind of place."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol, TypeVar

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import ModelFile

SpecT_contra = TypeVar("SpecT_contra", contravariant=True)


class Provider(Protocol[SpecT_contra]):
    """Fetches files from one kind of place."""

    def provide(
        self, spec: SpecT_contra, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """Yield each file with where it lies now: below `staging`, on the same file system.

        Nothing is said of its bytes; the caller checks them. Counts in `progress` are relative to
        the files asked for. Raises `SourceFailed`.
        """
