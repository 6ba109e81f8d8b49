"""Each commit has a later version than the one before, with no tag."""

import shutil
import subprocess
from pathlib import Path

import pytest
from packaging.version import Version

import edgevox
from edgevox.core import version as module
from edgevox.core.version import DISTRIBUTION, version_of

DECLARED = "1.2.3.dev"
PLACE = Path("edgevox", "core", "version.py")


class Tree:
    """A repository with nothing but the file that declares the version, as git has it."""

    def __init__(self, root: Path) -> None:
        self.root, self.file = root, root / PLACE
        self.file.parent.mkdir(parents=True)

    def git(self, *arguments: str, cwd: Path | None = None) -> str:
        named = ("-c", "user.name=A", "-c", "user.email=a@b.c", "-c", "protocol.file.allow=always")
        command = ["git", *named, *arguments]
        ran = subprocess.run(command, cwd=cwd or self.root, capture_output=True, text=True)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout

    def commit(self, text: str, *, to: str = DECLARED) -> None:
        self.file.write_text(f'# {text}\nDECLARED = "{to}"\n')
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message", text)

    def version(self, declared: str = DECLARED, root: Path | None = None) -> str:
        version_of.cache_clear()
        return version_of((root or self.root) / PLACE, declared)


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    tree = Tree(tmp_path / "tree")
    tree.git("init", "--quiet")
    return tree


def test_every_commit_has_a_later_version_than_the_one_before(tree: Tree) -> None:
    seen = []
    for number in range(12):
        tree.commit(f"change {number}")
        seen.append(tree.version())
    assert seen[0] == "1.2.3.dev0"
    assert [Version(one) for one in seen] == sorted({Version(one) for one in seen})


def test_a_release_is_called_what_its_commit_says_and_counting_begins_anew_after_it(
    tree: Tree,
) -> None:
    tree.commit("a change")
    tree.commit("release", to="1.2.3")
    assert tree.version("1.2.3") == "1.2.3"
    tree.commit("go on", to="1.2.4.dev")
    tree.commit("a change", to="1.2.4.dev")
    assert tree.version("1.2.4.dev") == "1.2.4.dev1"


def test_a_clone_without_tags_and_a_shallow_one_have_a_version(tree: Tree, tmp_path: Path) -> None:
    for number in range(3):
        tree.commit(f"change {number}")
    address = f"file://{tree.root}"
    tree.git("clone", "--quiet", "--no-tags", address, "whole", cwd=tmp_path)
    tree.git("clone", "--quiet", "--depth=1", address, "shallow", cwd=tmp_path)
    assert tree.version(root=tmp_path / "whole") == "1.2.3.dev2"
    assert tree.version(root=tmp_path / "shallow") == "1.2.3.dev0"


def test_an_archive_without_a_repository_has_a_version(tree: Tree, tmp_path: Path) -> None:
    tree.commit("a change")
    shutil.copytree(tree.root / "edgevox", tmp_path / "unpacked" / "edgevox")
    assert tree.version(root=tmp_path / "unpacked") == "1.2.3.dev0"


def test_what_was_built_keeps_the_version_that_it_was_built_with(
    tree: Tree, tmp_path: Path
) -> None:
    about = f"Metadata-Version: 2.4\nName: {DISTRIBUTION}\nVersion: 1.2.3.dev7\n"
    source, packages = tmp_path / "source", tmp_path / "site-packages"
    source.mkdir()
    (source / "PKG-INFO").write_text(about)
    installed = packages / "edgevox_robot-1.2.3.dev7.dist-info"
    installed.mkdir(parents=True)
    (installed / "METADATA").write_text(about)
    assert tree.version(root=source) == tree.version(root=packages) == "1.2.3.dev7"


def test_where_git_does_not_answer_there_is_a_version(
    tree: Tree, monkeypatch: pytest.MonkeyPatch
) -> None:
    tree.commit("a change")
    monkeypatch.setenv("PATH", "/nowhere")
    assert tree.version() == "1.2.3.dev0"


def test_the_package_has_it() -> None:
    assert edgevox.__version__ == module.version()
    assert Version(edgevox.__version__) >= Version(module.DECLARED)
