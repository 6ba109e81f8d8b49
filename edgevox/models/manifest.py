"""The manifest: which models there are, and what is known of each."""

import tomllib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Self

from pydantic import Field, model_validator

from edgevox.core.errors import InvalidValue
from edgevox.models.source_specs import ManifestEntry, SafePath, Source

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
