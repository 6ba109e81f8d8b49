"""`edgevox state`: move what a robot was taught, and who may open its console, to another computer.

One archive has the remembered places, and the console's certificate, key and paired browsers. It
has no recordings, which are large, no voice prints, which are people's own, and none of the site's
own files (policy, robot, security), which are where the site keeps them. **It contains keys**:
whoever has it can command the robot.
"""

import argparse
import io
import json
import os
import stat
import sys
import tarfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from edgevox import __version__
from edgevox.apps.folders import (
    console_folder,
    places_folder,
    recordings_folder,
    voiceprints_folder,
)
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError
from edgevox.core.files.state_files import PRIVATE, write_atomically
from edgevox.core.settings import load_settings

OK, FAILED = 0, 1
FOLDERS = {"places": places_folder, "console": console_folder}
"""The folders whose files are the robot's state, by their names in an archive."""
ABOUT, FORMAT = "edgevox-state.json", 1
MOST_BYTES, MOST_FILES = 64 * 2**20, 10_000
STREAM = "-"


@with_streams("edgevox state", results=True)
def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 if all is well, else 1 and a line that says why."""
    asked = _parser().parse_args(argv)
    try:
        settings = load_settings({}, asked.config)
        folders = {name: folder_of(settings) for name, folder_of in FOLDERS.items()}
        if asked.command == "export":
            _export(folders, recordings_folder(settings), asked.file)
        else:
            _import(folders, asked.file, replace=asked.replace)
    except (EdgeVoxError, OSError, tarfile.TarError) as error:
        show(f"edgevox state: {error}", error=True)
        return FAILED
    return OK


def written(folders: Mapping[str, Path], without: Path) -> bytes:
    """The archive, as bytes; nothing below `without`. Raises `OSError`."""
    about = {
        "format": FORMAT,
        "version": __version__,
        "made": time.strftime("%FT%TZ", time.gmtime()),
    }
    files = ((name, file.read_bytes()) for name, file in _files(folders, without))
    return tar_of([(ABOUT, json.dumps(about).encode()), *files])


def tar_of(files: Iterable[tuple[str, bytes]]) -> bytes:
    """An archive of these files by name, which only its owner may read."""
    archive = io.BytesIO()
    with tarfile.open(fileobj=archive, mode="w") as tar:
        for name, data in files:
            member = tarfile.TarInfo(name)
            member.size, member.mode, member.mtime = len(data), PRIVATE, int(time.time())
            tar.addfile(member, io.BytesIO(data))
    return archive.getvalue()


def write_archive(archive: bytes, file: str) -> bool:
    """Write it to a new file that only its owner may read, or to standard output.

    Returns whether it is a file. A file that a shell made of standard output becomes its owner's
    alone, too; one at the other end of a pipe cannot. Raises `OSError`.
    """
    if file == STREAM:
        with suppress(OSError):
            output = sys.stdout.buffer.fileno()
            if stat.S_ISREG(os.fstat(output).st_mode):
                os.fchmod(output, PRIVATE)
        sys.stdout.buffer.write(archive)
        return False
    descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, PRIVATE)
    with os.fdopen(descriptor, "wb") as output:
        output.write(archive)
    return True


def read(archive: BinaryIO) -> dict[str, str]:
    """The files of an archive, by their names in it. Raises `EdgeVoxError`, `TarError`."""
    files: dict[str, str] = {}
    total = 0
    with tarfile.open(fileobj=archive, mode="r|") as tar:
        for member in tar:
            total += member.size
            path = PurePosixPath(member.name)
            if not member.isfile() or path.is_absolute() or ".." in path.parts:
                raise EdgeVoxError(f"{member.name!r}: expected a file within the archive")
            if total > MOST_BYTES or len(files) >= MOST_FILES:
                raise EdgeVoxError(f"expected at most {MOST_FILES} files and {MOST_BYTES} bytes")
            content = tar.extractfile(member)
            try:
                files[str(path)] = content.read().decode("utf-8") if content else ""
            except UnicodeDecodeError:
                raise EdgeVoxError(f"{member.name!r}: expected text in UTF-8") from None
    _check_about(files.pop(ABOUT, ""))
    if odd := [name for name in files if name.partition("/")[0] not in FOLDERS]:
        raise EdgeVoxError(f"{odd[0]!r}: expected a file in {'/ or '.join(FOLDERS)}/")
    return files


def _check_about(text: str) -> None:
    try:
        about = json.loads(text)
        known = about["format"] == FORMAT
    except (ValueError, KeyError, TypeError):
        raise EdgeVoxError("expected an archive of `edgevox state export`") from None
    if not known:
        raise EdgeVoxError(f"format {about['format']}: expected {FORMAT}, of this version")


def _files(folders: Mapping[str, Path], without: Path) -> Iterator[tuple[str, Path]]:
    """All files, with their names in an archive; one folder may be in another."""
    apart = {*folders.values(), without, voiceprints_folder()}
    for part, top in folders.items():
        for folder, inner, names in os.walk(top):
            inner[:] = [one for one in sorted(inner) if Path(folder, one) not in apart]
            for name in sorted(names):
                file = Path(folder, name)
                if file.is_file() and not file.is_symlink() and not name.startswith("."):
                    yield f"{part}/{file.relative_to(top)}", file


def _export(folders: Mapping[str, Path], without: Path, file: str) -> None:
    archive = written(folders, without)
    names = (name for name, _ in _files(folders, without))
    if write_archive(archive, file):
        show(f"{file}: it contains keys, so keep it as you keep a password")
    show(f"edgevox state: {_told(names, folders)}", error=True)


def _told(names: Iterable[str], folders: Mapping[str, Path]) -> str:
    """How many files each folder has: it shows where one is not the one that is kept."""
    count = Counter(name.partition("/")[0] for name in names)
    return "files: " + ", ".join(f"{count[part]} in {one}" for part, one in folders.items())


def _import(folders: Mapping[str, Path], file: str, *, replace: bool) -> None:
    if file == STREAM:
        files = read(sys.stdin.buffer)
    else:
        with Path(file).open("rb") as archive:
            files = read(archive)
    parts = ((*name.partition("/"), text) for name, text in files.items())
    targets = {folders[part] / name: text for part, _, name, text in parts}
    if there := [target for target in targets if target.exists() and not replace]:
        raise EdgeVoxError(f"{there[0]}: is there already; --replace takes the archive's instead")
    for target, text in targets.items():
        target.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_atomically(target, text)
    told = _told(files, folders)
    show(f"{told}; start the robot now, since one that runs does not read them again")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox state",
        description="Move a robot's remembered places and its console's keys to another computer."
        " End the robot first.",
    )
    parser.add_argument("--config", type=Path, metavar="FILE", help="the robot's settings")
    commands = parser.add_subparsers(dest="command", required=True)
    export = commands.add_parser("export", help="write an archive, which contains keys")
    export.add_argument("file", metavar="FILE", help="a new file, or - for the output")
    take = commands.add_parser("import", help="read an archive")
    take.add_argument("file", metavar="FILE", help="an archive, or - for the input")
    take.add_argument("--replace", action="store_true", help="also over files that are there")
    return parser
