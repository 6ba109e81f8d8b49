"""What can go wrong with models."""

from collections.abc import Sequence
from pathlib import Path

from edgevox.core.errors import EdgeVoxError
from edgevox.models.manifest import Model, ModelFile


class ModelMissing(EdgeVoxError):
    """A model is not on this machine, or a file of it is damaged."""

    def __init__(self, model: Model, folder: Path, files: Sequence[ModelFile]) -> None:
        names = ", ".join(file.name for file in files)
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

    def __init__(
        self, model: Model, folder: Path, files: Sequence[ModelFile], tried: Sequence[str]
    ) -> None:
        lines = [f"model {model.id} could not be fetched. Tried:"]
        lines += [f"  - {attempt}" for attempt in tried]
        lines += ["To provide it by hand, copy from any machine that has it:"]
        lines += [f"  {folder / f.name}  ({f.size} bytes, sha256 {f.sha256})" for f in files]
        super().__init__("\n".join(lines))
