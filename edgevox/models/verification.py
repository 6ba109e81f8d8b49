"""Files are hashed once; a stamp beside them remembers which bytes were seen."""

import hashlib
import json
from contextlib import suppress
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.log import get_logger
from edgevox.models.manifest import ModelFile

log = get_logger(__name__)
STAMPS = ".verified.json"


def is_whole(folder: Path, file: ModelFile) -> bool:
    """Whether the file is there with the right bytes, by its stamp if it has a fresh one."""
    path = folder / file.name
    try:
        seen = path.stat()
    except OSError:
        return False
    if not path.is_file() or seen.st_size != file.size:
        return False
    if _read_stamps(folder).get(file.name) == _stamp(path, file):
        return True
    return has_right_bytes(path, file) and remember(folder, file)


def has_right_bytes(path: Path, file: ModelFile) -> bool:
    """Whether the whole file, read from disk, has the size and the hash of the manifest."""
    if not path.is_file() or path.stat().st_size != file.size:
        return False
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest() == file.sha256


def remember(folder: Path, file: ModelFile) -> bool:
    """Stamp a file whose bytes are right; always True. A folder that is read-only has no stamps."""
    stamps = _read_stamps(folder) | {file.name: _stamp(folder / file.name, file)}
    fresh = folder / f"{STAMPS}.new"
    try:
        fresh.write_text(json.dumps(stamps, indent=1), encoding="utf-8")
        fresh.replace(folder / STAMPS)
    except OSError as error:
        log.debug("model_not_stamped", file=str(folder / file.name), reason=str(error))
    return True


def forget(folder: Path) -> None:
    """Drop all stamps, so that the next look hashes again; a read-only folder keeps its own."""
    with suppress(OSError):
        (folder / STAMPS).unlink(missing_ok=True)


def _stamp(path: Path, file: ModelFile) -> str:
    # Whole seconds: image layers and archives keep no finer times.
    return f"{file.sha256} {file.size} {int(path.stat().st_mtime)}"


def _read_stamps(folder: Path) -> dict[str, str]:
    try:
        stamps = json.loads(read_text(folder / STAMPS, STAMPS))
    except (InvalidValue, ValueError, RecursionError):  # then they are made again
        return {}
    return stamps if isinstance(stamps, dict) else {}
