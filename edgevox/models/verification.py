"""Files are hashed once; a stamp beside them remembers which bytes were seen."""

import hashlib
import json
import stat
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
    stamp = _stamp(folder / file.name, file)
    if stamp is None:
        return False
    if _read_stamps(folder).get(file.name) == stamp:
        return True
    return has_right_bytes(folder / file.name, file) and remember(folder, file)


def has_right_bytes(path: Path, file: ModelFile) -> bool:
    """Whether the whole file, read from disk, has the size and the hash of the manifest.

    False where it cannot be read, since it may also vanish meanwhile.
    """
    if _stamp(path, file) is None:
        return False
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest() == file.sha256
    except OSError:
        return False


def remember(folder: Path, file: ModelFile) -> bool:
    """Stamp a file whose bytes are right; always True. A folder that is read-only has no stamps."""
    if (stamp := _stamp(folder / file.name, file)) is None:  # replaced or removed meanwhile
        return True
    stamps = _read_stamps(folder) | {file.name: stamp}
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


def _stamp(path: Path, file: ModelFile) -> str | None:
    """The stamp of a file as it is now; None if it is absent, no file, or of another size."""
    try:
        seen = path.stat()  # once: it may vanish between two questions
    except OSError:
        return None
    if not stat.S_ISREG(seen.st_mode) or seen.st_size != file.size:
        return None
    # Whole seconds: image layers and archives keep no finer times.
    return f"{file.sha256} {file.size} {int(seen.st_mtime)}"


def _read_stamps(folder: Path) -> dict[str, str]:
    try:
        stamps = json.loads(read_text(folder / STAMPS, STAMPS))
    except (InvalidValue, ValueError, RecursionError):  # then they are made again
        return {}
    return stamps if isinstance(stamps, dict) else {}
