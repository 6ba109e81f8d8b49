"""Where half-fetched files lie on a workbench, apart from what the sources keep there."""

from pathlib import Path

from edgevox.models.manifest import ModelFile


def place_for(file: ModelFile, bench: Path) -> Path:
    """A path for the file below the bench; its folder is there, the file may be."""
    path = bench / "files" / file.name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
