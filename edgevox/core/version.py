"""The version: of a release, or of a commit after it.

`DECLARED` changes with a release only: a release's commit writes "0.1.1", the next "0.1.2.dev". A
version that ends in ``.dev`` gets the number of commits since that line was written, so that each
commit has a later version than the one before. No tag is needed, which a clone may lack. An
archive, or an image that is built without the repository, is ``.dev0``, unless the builder writes
the whole version into `DECLARED`.

The build runs this file by itself (`pyproject.toml`): it imports nothing of EdgeVox.
"""

import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path

DECLARED = "0.1.1.dev"
DISTRIBUTION = "edgevox-robot"
GIT_S = 10.0
"""Seconds that git may take."""


def version() -> str:
    """The version of what runs."""
    return version_of(Path(__file__).resolve())


@cache
def version_of(file: Path, declared: str = DECLARED) -> str:
    """The version of the tree or the package that this file of EdgeVox is in."""
    root = file.parents[2]
    if not declared.endswith(".dev"):
        return declared
    if (root / ".git").exists():
        return f"{declared}{_commits_since(file)}"
    if (root / "PKG-INFO").is_file():  # what was unpacked from a source distribution
        about = (root / "PKG-INFO").read_text(encoding="utf-8")
        return next(
            line.removeprefix("Version: ")
            for line in about.splitlines()
            if line.startswith("Version: ")
        )
    return _installed(root) or f"{declared}0"


def _installed(packages: Path) -> str:
    """The version of the distribution that was installed to this folder; empty if there is none."""
    found = metadata.distributions(name=DISTRIBUTION, path=[str(packages)])
    return next((one.version for one in found), "")


def _commits_since(file: Path) -> int:
    """How many commits there are since `DECLARED` was written; 0 where git does not know."""
    try:
        if _git(file, "rev-parse", "--is-shallow-repository") == "true":
            return 0
        declared = _git(file, "log", "-1", "--format=%H", "-G", "^DECLARED = ", "--", str(file))
        return int(
            _git(file, "rev-list", "--count", "HEAD", *([f"^{declared}"] if declared else []))
        )
    except (OSError, ValueError, subprocess.SubprocessError):
        return 0


def _git(file: Path, *arguments: str) -> str:
    return subprocess.run(
        ["git", *arguments],
        cwd=file.parent,
        check=True,
        capture_output=True,
        text=True,
        timeout=GIT_S,
    ).stdout.strip()
