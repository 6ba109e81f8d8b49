"""Where half-fetched files are staged, apart from what the sources keep there."""

from pathlib import Path

from edgevox.models.manifest import ModelFile


def place_for(file: ModelFile, staging: Path) -> Path:
    """A path for the file below the staging folder; its folder is there, the file may be."""
    path = staging / "files" / file.name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
