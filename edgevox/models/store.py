"""The folder where models live, one folder a model: ``<root>/<id>/<file>``.

Files are hashed once; a stamp beside them remembers which bytes were seen. What can go wrong with
models is here, too.
"""

import fcntl
import hashlib
import json
import os
import shutil
import stat
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib.resources import files
from pathlib import Path
from typing import Self

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.log import get_logger
from edgevox.models.manifest import NOTICE, Manifest, Model, ModelFile, builtin_manifest

log = get_logger(__name__)

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


ROOT_VARIABLE = "EDGEVOX_MODELS_DIR"
PARTIAL = ".partial"


def default_root(environment: Mapping[str, str] = os.environ) -> Path:
    """``$EDGEVOX_MODELS_DIR``, else ``edgevox/models`` in the user's cache."""
    if chosen := environment.get(ROOT_VARIABLE):
        return Path(chosen).expanduser().absolute()
    cache = environment.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return Path(cache) / "edgevox" / "models"


def locate(model_id: str) -> Path:
    """Where a model of the built-in manifest is: its entry file, or its folder if it has none.

    Raises `UnknownModel`, or `ModelMissing` naming the command that fetches it.
    """
    return Store().locate(model_id)


class Store:
    """Models on this machine. A file in it is whole, under its name, or it counts as absent."""

    def __init__(self, root: Path | None = None, manifest: Manifest | None = None) -> None:
        self.root = root or default_root()
        self.manifest = manifest or builtin_manifest()

    def folder(self, model: Model) -> Path:
        """Where the model's files belong."""
        return self.root / model.id

    def locate(self, model_id: str) -> Path:
        """See the function `locate`."""
        (model, *_) = self.manifest.select([model_id])
        if missing := self.missing(model):
            raise ModelMissing(model, self.folder(model), missing)
        return self.folder(model) / model.entry

    def missing(self, model: Model) -> tuple[ModelFile, ...]:
        """The files that are absent, cut short or wrong."""
        folder = self.folder(model)
        return tuple(file for file in model.files if not is_whole(folder, file))

    def verify(self, model: Model) -> tuple[ModelFile, ...]:
        """As `missing`, but every byte is read again."""
        folder = self.folder(model)
        wrong = [f for f in model.files if not has_right_bytes(folder / f.name, f)]
        if wrong and folder.is_dir():
            forget(folder)
        return tuple(wrong)

    def adopt(self, model: Model, file: ModelFile, path: Path) -> None:
        """Move a fetched file to its place, at once and only if its bytes are right.

        Raises `SourceFailed`; the wrong file is deleted then.
        """
        if not has_right_bytes(path, file):
            size = path.stat().st_size if path.is_file() else 0
            path.unlink(missing_ok=True)
            raise SourceFailed(f"{file.name} has other bytes than expected ({size} of {file.size})")
        place = self.folder(model) / file.name
        place.parent.mkdir(parents=True, exist_ok=True)
        path.replace(place)
        remember(self.folder(model), file)

    def finish(self, model: Model) -> None:
        """Put the licence beside the model's files and remove the staging folder."""
        folder = self.folder(model)
        urls = [self.manifest.licences[licence].url for licence in model.licences]
        head = [model.title, model.publisher, model.copyright, model.caution, *urls]
        texts = ["\n".join(line for line in head if line)]
        texts += [_licence_text(licence) for licence in model.licences[bool(model.licence_file) :]]
        if model.licence_file:
            texts.insert(
                1, (folder / model.licence_file).read_text(encoding="utf-8", errors="replace")
            )
        (folder / NOTICE).write_text("\n\n".join(texts), encoding="utf-8")
        shutil.rmtree(folder / PARTIAL, ignore_errors=True)

    @contextmanager
    def staging_folder(self, model: Model, waiting: Callable[[], None]) -> Iterator[Path]:
        """A folder for half-fetched files of one model, held by one process at a time.

        Calls `waiting` if another process holds it. What is left in it is there the next time.
        Raises `StoreNotWritable`.
        """
        staging = self.folder(model) / PARTIAL
        try:
            staging.mkdir(parents=True, exist_ok=True)
            lock = (self.root / f".{model.id}.lock").open("wb")
        except OSError as error:
            raise StoreNotWritable(
                f"models: cannot write to {self.root}: {error.strerror}; "
                f"choose another folder with {ROOT_VARIABLE}"
            ) from None
        with lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                waiting()
                fcntl.flock(lock, fcntl.LOCK_EX)
            staging.mkdir(parents=True, exist_ok=True)
            try:
                yield staging
            finally:
                _remove_empty(staging, self.folder(model))


def _licence_text(licence: str) -> str:
    return (
        files("edgevox.models").joinpath("licences", f"{licence}.txt").read_text(encoding="utf-8")
    )


def _remove_empty(*folders: Path) -> None:
    for folder in folders:
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
