"""Packages from a folder that an operator names: robots and skills, without an installation.

The loader puts the folder's packages where Python and `importlib.metadata` find them. Nothing is
fetched, built or installed. Imports only core; the programs import it.

`plugins.sha256`, if there, lists the only files that the folder may hold. A package may also be a
project's source folder, not built: `importlib.metadata` finds it by its pyproject.toml as if it
were installed, with its entry points.
"""

import argparse
import atexit
import hashlib
import os
import re
import shutil
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import (
    Distribution,
    DistributionFinder,
    PackageNotFoundError,
    PathDistribution,
    distribution,
)
from pathlib import Path
from typing import Any, NoReturn, cast

from edgevox.apps.flags import add_flags, given_flags
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.user_file import open_file, read_text
from edgevox.core.log import get_logger
from edgevox.core.settings import ENV_PREFIX, written_in

log = get_logger(__name__)


HASHES = "plugins.sha256"
LARGEST_BYTES = 200_000_000
_LINE = re.compile(r"([0-9a-f]{64}) [ *](?:\./)?(.+)")


def check_hashes(folder: Path) -> None:
    """Raises `InvalidValue` unless such a file, if there is one, tells of all and is right.

    A file that it does not name is refused as well: Python would run one that was put there.
    """
    listing = folder / HASHES
    if not os.path.lexists(listing):  # one that leads nowhere is there, and cannot be read
        return
    wanted = _wanted(listing)
    found = set(_files(folder))
    for name in sorted(wanted.keys() | found):
        field = f"plugins: {name}"
        if name not in found:
            raise InvalidValue(field, str(folder), f"the file that {HASHES} names")
        if name not in wanted:
            raise InvalidValue(field, str(folder), f"no file that {HASHES} does not name")
        if (digest := _sha256(folder / name, field)) != wanted[name]:
            raise InvalidValue(field, digest, f"{wanted[name]}, as {HASHES} says")


def _wanted(listing: Path) -> dict[str, str]:
    wanted = {}
    for number, line in enumerate(read_text(listing, HASHES).splitlines(), 1):
        if not line.strip():
            continue
        if (parts := _LINE.fullmatch(line)) is None:
            raise InvalidValue(f"{HASHES}: line {number}", line, "a SHA-256, two spaces, a file")
        wanted[parts[2]] = parts[1]
    return wanted


def _files(folder: Path) -> Iterator[str]:
    """Yield the loadable files, without Kubernetes' own, such as `..data`, beside its mounts."""
    seen: set[tuple[int, int]] = set()
    for place, folders, names in os.walk(folder, followlinks=True):
        here = Path(place)
        identity = here.stat().st_dev, here.stat().st_ino
        if identity in seen:  # followed for ever, or twice as often at each level
            field = f"plugins: {here.relative_to(folder).as_posix()}"
            raise InvalidValue(field, str(folder), "each folder once, by one name")
        seen.add(identity)
        folders[:] = [one for one in folders if here != folder or not one.startswith(".")]
        for name in names:
            relative = (here / name).relative_to(folder)
            if not (here == folder and (name == HASHES or name.startswith("."))):
                yield relative.as_posix()


def _sha256(file: Path, field: str) -> str:
    with open_file(file, field, LARGEST_BYTES) as stream:
        return hashlib.sha256(stream.read(LARGEST_BYTES)).hexdigest()


PROJECT = "pyproject.toml"


class SourcePackage(Distribution):
    """The metadata of a package in a project's folder.

    Raises `InvalidValue` for an invalid project.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        file = folder / PROJECT
        try:
            parsed = tomllib.loads(read_text(file, PROJECT))
        except (ValueError, RecursionError) as error:
            raise InvalidValue(PROJECT, str(file), f"valid TOML ({error})") from None
        project = parsed.get("project")
        if not isinstance(project, dict) or not isinstance(project.get("name"), str):
            raise InvalidValue(f"{PROJECT}: project.name", str(file), "the package's name")
        self._metadata = _metadata(project)
        self._points = _entry_points(project)

    @property
    def import_path(self) -> Path:
        """The folder that its modules are in."""
        src = self._folder / "src"
        return src if src.is_dir() else self._folder

    def read_text(self, filename: str) -> str | None:
        """Return the content that an installed package would have in this file."""
        return {"METADATA": self._metadata, "entry_points.txt": self._points}.get(filename)

    def locate_file(self, path: Any) -> Any:
        """Return the path of one of its files."""
        return self._folder / path


class SourceFinder(DistributionFinder):
    """Tells `importlib.metadata` of such packages; their modules are found by the path."""

    def __init__(self) -> None:
        self.packages: list[SourcePackage] = []

    @classmethod
    def installed(cls) -> "SourceFinder":
        """The one of this process."""
        for finder in sys.meta_path:
            if isinstance(finder, cls):
                return finder
        finder = cls()
        sys.meta_path.append(cast("Any", finder))
        return finder

    def find_spec(self, *_: object) -> None:
        """No module is found by this."""

    def find_distributions(
        self, context: DistributionFinder.Context | None = None
    ) -> Iterable[Distribution]:
        """All of them, or the one of the name that is asked for."""
        wanted = context.name if context else None
        return [one for one in self.packages if wanted in (None, one.name)]


def _metadata(project: dict[str, Any]) -> str:
    lines = [f"Name: {project['name']}", f"Version: {project.get('version', '0')}"]
    needs = project.get("dependencies", [])
    if not isinstance(needs, list):
        _refuse("dependencies", needs, "a list of packages")
    lines += [f"Requires-Dist: {need}" for need in needs]
    return "Metadata-Version: 2.1\n" + "".join(f"{line}\n" for line in lines)


def _entry_points(project: dict[str, Any]) -> str:
    groups = project.get("entry-points", {})
    if not isinstance(groups, dict) or not all(isinstance(one, dict) for one in groups.values()):
        _refuse("entry-points", groups, "tables of names")
    return "".join(_group(name, points) for name, points in groups.items())


def _group(name: str, points: dict[str, object]) -> str:
    def lines() -> Iterator[str]:
        yield f"[{name}]\n"
        for point, value in points.items():
            yield f"{point} = {value}\n"

    return "".join(lines())


def _refuse(field: str, value: object, expected: str) -> NoReturn:
    raise InvalidValue(f"{PROJECT}: project.{field}", value, expected)


EXPECTED = f"a wheel, or a folder with {PROJECT} or what pip install --target makes"
_COMPILED = "a wheel of Python alone (none-any); unpack one with compiled code into a folder"
_INFO = ".dist-info"
_NAME = re.compile(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)([^;]*)(;.*)?")


@dataclass(frozen=True)
class Plugin:
    """A package that was found, with its file or folder."""

    file: str
    name: str
    version: str


@dataclass(frozen=True)
class Plugins:
    """The plug-ins of a folder."""

    loaded: tuple[Plugin, ...] = ()
    broken: Mapping[str, str] = field(default_factory=dict)
    """The reason of each failure, by file."""

    @property
    def complaint(self) -> str:
        """The broken plug-ins, a line each, for people; empty if there is none."""
        return "\n".join(f"plugins: {file}: {reason}" for file, reason in self.broken.items())

    def log(self) -> None:
        """Tell of each, by name."""
        for one in self.loaded:
            log.info("plugin_loaded", file=one.file, plugin=one.name, version=one.version)
        for file, reason in self.broken.items():
            log.error("plugin_broken", file=file, reason=reason)


def plugins_folder(argv: Sequence[str]) -> Path | None:
    """Return the folder of `--plugins`, else of its variable, else of the file of `--config`.

    It is read before everything else, since the known robots depend on it.
    """
    parser = argparse.ArgumentParser(add_help=False, exit_on_error=False)
    add_flags(parser, ["plugins"])
    try:
        arguments, _ = parser.parse_known_args(argv)
    except argparse.ArgumentError:
        return None  # told by the whole parser, with its usage
    folder = given_flags(arguments).get("plugins") or os.environ.get(f"{ENV_PREFIX}PLUGINS")
    if not folder and arguments.config:
        folder = written_in(arguments.config).get("plugins")
    return Path(str(folder)) if folder else None


def bring_plugins(folder: Path | None, *, load: bool = True) -> Plugins:
    """Make the folder's packages known to this process, after all that is installed.

    One that is broken is left out. Without `load` their entry points are known and may not be
    loaded: nothing is unpacked. Raises `InvalidValue` for a folder that is none, and where
    `plugins.sha256` is there and not everything is as it says.
    """
    if folder is None:
        return Plugins()
    if not folder.is_dir():
        raise InvalidValue("plugins", str(folder), "a folder")
    folder = folder.absolute()
    check_hashes(folder)
    loaded: list[tuple[Plugin, Distribution]] = []
    broken: dict[str, str] = {}
    for item in sorted(folder.iterdir()):
        if item.name.startswith(".") or item.name == HASHES:
            continue
        try:
            place, packages = _found(item, load)
            plugins = [(_plugin(item.name, package), package) for package in packages]
        except (EdgeVoxError, OSError) as error:
            broken[item.name] = str(error)
        except Exception as error:  # noqa: BLE001 - zipfile and importlib raise what they like
            broken[item.name] = f"{type(error).__name__}: {error}"
        else:
            _put(place, packages)
            loaded += plugins
    for one, package in loaded:
        if missing := _missing(package):
            broken[one.file] = f"{one.name} needs {', '.join(missing)}: nothing is fetched"
    return Plugins(tuple(one for one, _ in loaded if one.file not in broken), broken)


def _found(item: Path, load: bool) -> tuple[Path, Sequence[Distribution]]:
    """Return the folder of its modules, and its packages. Raises any error for an invalid one.

    Nothing is put on the path yet: there, an unreadable plug-in would hide all others.
    """
    if item.is_file() and item.suffix == ".whl":
        if not item.name.endswith("-none-any.whl"):
            raise EdgeVoxError(f"expected {_COMPILED}")
        about = [one for one in zipfile.Path(item).iterdir() if one.name.endswith(_INFO)]
        place = _unpacked(item) if load and _has_data(item) else item
        return place, _expected([PathDistribution(one) for one in about])
    if item.is_dir() and (infos := sorted(item.glob("*.dist-info"))):
        for file in (one for info in infos for one in info.iterdir()):
            if not (file.is_file() or file.is_dir()):  # a pipe would be waited for
                raise EdgeVoxError(f"{file.name} is no file")
        return item, [PathDistribution(one) for one in infos]
    if item.is_dir() and (item / PROJECT).is_file():
        package = SourcePackage(item)
        return package.import_path, [package]
    raise EdgeVoxError(f"expected {EXPECTED}")


def _expected(packages: list[Distribution]) -> list[Distribution]:
    if not packages:
        raise EdgeVoxError(f"expected {EXPECTED}")
    return packages


def _has_data(wheel: Path) -> bool:
    """Return whether it holds more than modules.

    Code that reads a file beside itself needs a folder.
    """
    with zipfile.ZipFile(wheel) as archive:
        names = [one.filename for one in archive.infolist() if not one.is_dir()]
    return not all(one.endswith(".py") or one.partition("/")[0].endswith(_INFO) for one in names)


def _unpacked(wheel: Path) -> Path:
    """A folder with what is in it, which is gone when the program ends."""
    folder = Path(tempfile.mkdtemp(prefix="edgevox-plugin-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def _put(place: Path, packages: Sequence[Distribution]) -> None:
    """Append it to the path: a plug-in replaces nothing that is installed."""
    if str(place) not in sys.path:
        sys.path.append(str(place))
    sources = [one for one in packages if isinstance(one, SourcePackage)]
    if sources:
        SourceFinder.installed().packages.extend(sources)


def _plugin(file: str, package: Distribution) -> Plugin:
    name = package.metadata["Name"]
    if not name:
        raise EdgeVoxError("expected a package with a name in its metadata")
    for _ in (*package.entry_points, *(package.requires or ())):
        pass  # what Python asks of all packages at once can be read
    return Plugin(file, name, package.version)


def _missing(package: Distribution) -> list[str]:
    """The packages that one needs and that are not here, but for those under a condition."""

    def needed() -> Iterator[str]:
        for need in package.requires or ():
            parts = _NAME.fullmatch(need)
            if parts and not parts[3]:
                yield parts[1]

    return [one for one in needed() if not _is_here(one)]


def _is_here(name: str) -> bool:
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True
