"""A folder of a git repository at one commit; only that folder's files are transferred."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import GitSource, ModelFile
from edgevox.models.model_errors import SourceFailed
from edgevox.models.sources.tools import run_tool

TIMEOUT_S = 1800.0
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
