"""A package as it lies in its folder, not built: what its pyproject.toml says of it.

`importlib.metadata` finds it as if it were installed, its entry points with it.
"""

import sys
import tomllib
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, DistributionFinder
from pathlib import Path
from typing import Any, NoReturn, cast

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import read_text

PROJECT = "pyproject.toml"


class SourcePackage(Distribution):
    """What a project's folder says of the package in it. Raises `InvalidValue` for what is none."""

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
        """What an installed package would have in its file of this name."""
        return {"METADATA": self._metadata, "entry_points.txt": self._points}.get(filename)

    def locate_file(self, path: Any) -> Any:
        """Where one of its files is."""
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
