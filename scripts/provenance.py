"""Where a bundle comes from: its source, its image, and both as a statement in the form of SLSA."""

import hashlib
import io
import json
import subprocess
import tarfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from edgevox import __version__

REPOSITORY = "edgevox-ros2"
SBOM_IN_IMAGE = "/opt/edgevox/sbom.json"
INPUTS = ("Dockerfile.ros2", "docker/*", "requirements/*.lock", "edgevox/models/*.toml")
"""What decides what is in an image, besides the code."""


def output_of(*command: str, cwd: Path | None = None) -> str:
    """What a program prints. Raises `CalledProcessError` with what it says of a failure."""
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True).stdout.decode().strip()


@dataclass(frozen=True)
class Source:
    """A working tree."""

    commit: str
    date: int
    """Seconds since 1970 of the commit."""
    changed: bool
    """Whether files that git tracks differ from the commit."""

    @classmethod
    def of(cls, root: Path) -> Self:
        """Asks git. Raises `CalledProcessError` outside of a repository."""
        commit, date = output_of("git", "log", "-1", "--format=%H %ct", cwd=root).split()
        changed = output_of("git", "status", "--porcelain", "--untracked-files=no", cwd=root)
        return cls(commit, int(date), bool(changed))

    def __str__(self) -> str:
        return f"{self.commit}{' with changes' if self.changed else ''}"


@dataclass(frozen=True)
class Image:
    """An image of the engine on this machine."""

    name: str
    id: str
    """``sha256:`` and the hash of its configuration."""
    architecture: str
    engine: str
    labels: dict[str, str]

    @classmethod
    def named(cls, name: str) -> Self:
        """Asks the engine. Raises `CalledProcessError` if there is none of that name."""
        (about,) = json.loads(output_of("docker", "image", "inspect", name))
        engine = output_of("docker", "version", "--format", "{{.Server.Version}}")
        return cls(
            name, about["Id"], about["Architecture"], engine, about["Config"]["Labels"] or {}
        )

    @property
    def revision(self) -> str:
        """The commit that its label names, as who built it said; empty if there is none."""
        return self.labels.get("org.opencontainers.image.revision", "")

    @property
    def version(self) -> str:
        """The version that its label names; that of this source if there is none."""
        return self.labels.get("org.opencontainers.image.version") or __version__

    @property
    def tag(self) -> str:
        """The version and the beginning of its hash: another image has another."""
        return f"{self.version}-{self.id.removeprefix('sha256:')[:12]}"

    @contextmanager
    def tagged(self) -> Iterator[str]:
        """A name of this image alone, for as long as it is needed."""
        reference = f"{REPOSITORY}:{self.tag}"
        looked = ["docker", "image", "inspect", reference]
        there = subprocess.run(looked, check=False, capture_output=True)
        output_of("docker", "tag", self.id, reference)
        try:
            yield reference
        finally:
            if there.returncode != 0:
                output_of("docker", "rmi", reference)

    def read(self, path: str) -> bytes:
        """A file of it, without running anything. Raises `CalledProcessError`, `OSError`."""
        container = output_of("docker", "create", "--network=none", self.id, "nothing")
        try:
            command = ["docker", "cp", f"{container}:{path}", "-"]
            packed = subprocess.run(command, check=True, capture_output=True).stdout
        finally:
            output_of("docker", "rm", container)
        with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
            member = archive.getmember(Path(path).name)
            stream = archive.extractfile(member) if member.isfile() else None
            if stream is None:
                raise FileNotFoundError(f"{self.name}: {path} is no file")
            return stream.read()


def provenance(
    source: Source, image: Image, models: Sequence[str], root: Path
) -> dict[str, object]:
    """An in-toto statement with SLSA's predicate. Only the site's signature vouches for it."""
    listed = sorted(
        str(path.relative_to(root)) for name in INPUTS for path in root.glob(name) if path.is_file()
    )
    inputs = [{"name": name, "digest": {"sha256": sha256(root / name)}} for name in listed]
    commit = {
        "name": "source",
        "digest": {"gitCommit": source.commit},
        "annotations": {"changed": source.changed},
    }
    base = image.labels.get("org.opencontainers.image.base.name", "")
    return {
        "_type": "https://in-toto.io/Statement/v1",
        "subject": [{"name": image.name, "digest": {"sha256": image.id.removeprefix("sha256:")}}],
        "predicateType": "https://slsa.dev/provenance/v1",
        "predicate": {
            "buildDefinition": {
                "buildType": "urn:edgevox:bundle:1",
                "externalParameters": {"image": image.name, "models": list(models)},
                "internalParameters": {
                    "bundled_at": source.commit,
                    "image_says_it_was_built_from": image.revision,
                    "image_says_its_base_is": base,
                    "image_is_of_this_source": image.revision == source.commit
                    and not source.changed,
                },
                "resolvedDependencies": [commit, *inputs],
            },
            "runDetails": {
                "builder": {"id": "urn:edgevox:unattested", "version": {"docker": image.engine}},
            },
        },
    }


def sha256(path: Path) -> str:
    """The hash of a file, in hexadecimal digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
