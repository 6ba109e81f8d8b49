"""What can go wrong with models."""

from collections.abc import Sequence
from pathlib import Path
from typing import Self

from edgevox.core.errors import EdgeVoxError
from edgevox.models.manifest import Model, ModelFile

SHOWN = 5


class ModelMissing(EdgeVoxError):
    """A model is not on this machine, or a file of it is damaged."""

    def __init__(self, model: Model, folder: Path, files: Sequence[ModelFile]) -> None:
        names = ", ".join([*(file.name for file in files[:SHOWN]), *_and_more(files)])
        super().__init__(
            f"model {model.id}: {names} not found whole in {folder}; "
            f"get it with: edgevox-models fetch {model.id}"
        )


class StoreNotWritable(EdgeVoxError):
    """The folder of the models cannot be written, or has too little room."""


class SourceFailed(EdgeVoxError):
    """One source could not give a file; the next one is tried."""


class FetchFailed(EdgeVoxError):
    """No source could give a model. The message says what was tried and how to help by hand."""

    @classmethod
    def of(
        cls, model: Model, folder: Path, files: Sequence[ModelFile], tried: Sequence[str]
    ) -> Self:
        """The failure of one model, `files` of which are still missing."""
        lines = [f"model {model.id} could not be fetched. Tried:"]
        lines += [f"  - {attempt}" for attempt in tried]
        lines += ["To provide it by hand, copy from any machine that has it:"]
        lines += [f"  {folder / f.name}  ({f.size} bytes, {_hash(f)})" for f in files[:SHOWN]]
        lines += [f"  {more}" for more in _and_more(files)]
        return cls("\n".join(lines))

    @classmethod
    def of_all(cls, failures: Sequence[Self]) -> Self:
        """One failure that tells of several."""
        return cls("\n".join(str(failure) for failure in failures))


def _and_more(files: Sequence[ModelFile]) -> list[str]:
    return [f"and {len(files) - SHOWN} more"] if len(files) > SHOWN else []


def _hash(file: ModelFile) -> str:
    return f"sha256 {file.sha256}"
