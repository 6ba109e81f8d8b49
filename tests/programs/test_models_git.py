"""Fetching with the real git out of a repository on this machine."""

from pathlib import Path

import pytest
from models_sources import Repository, writing
from models_wheelhouse import entry, model, store

from edgevox.models import FetchFailed, Store, fetch
from edgevox.models.manifest import GitSource, Model

ARM, MESH = b"<mujoco/>\n", b"v 0 0 0\r\n" * 200
NOWHERE = "0" * 40


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    monkeypatch.delenv("EDGEVOX_OFFLINE", raising=False)
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", "/dev/null")
    monkeypatch.setenv("GIT_CONFIG_NOSYSTEM", "1")
    return Repository(tmp_path / "repository")


def publish(repository: Repository, arm: bytes = ARM) -> str:
    files = {"arm/arm.xml": arm, "arm/assets/link.obj": MESH, "leg/leg.xml": b"x" * 5000}
    return repository.commit(writing(files))


def arm_from(url: str, commit: str) -> Model:
    source = {"kind": "git", "url": url, "commit": commit, "folder": "arm"}
    return model("arm", [entry("arm.xml", ARM), entry("assets/link.obj", MESH)], source)


def test_the_pinned_commit_is_fetched_not_the_newest(
    repository: Repository, tmp_path: Path
) -> None:
    pinned = publish(repository)
    publish(repository, b"<mujoco>newer</mujoco>")

    (path,) = fetch(["arm"], store=store(tmp_path, arm_from(repository.url, pinned)))

    assert path.read_bytes() == ARM
    assert (path.parent / "assets" / "link.obj").read_bytes() == MESH
    assert not (path.parent / ".partial").exists()


def test_only_the_folder_of_the_model_is_transferred(
    repository: Repository, tmp_path: Path
) -> None:
    here = store(tmp_path, arm_from(repository.url, publish(repository, b"other bytes")))

    with pytest.raises(FetchFailed, match="other bytes"):
        fetch(["arm"], store=here)

    tree = here.root / "arm" / ".partial" / "git"
    assert (tree / "arm" / "assets").is_dir()
    assert not (tree / "leg").exists()


def test_a_fetch_that_was_killed_goes_on(repository: Repository, tmp_path: Path) -> None:
    here = store(tmp_path, arm_from(repository.url, publish(repository)))
    left = here.root / "arm" / ".partial" / "git" / ".git" / "index.lock"
    left.parent.mkdir(parents=True)
    left.touch()

    fetch(["arm"], store=here)

    assert not here.missing(here.manifest.models["arm"])


def fails(here: Store, reason: str) -> None:
    with pytest.raises(FetchFailed, match=reason):
        fetch(["arm"], store=here)
    assert not (here.root / "arm" / "arm.xml").exists()


def test_a_repository_out_of_reach_is_a_failed_source(
    repository: Repository, tmp_path: Path
) -> None:
    gone = (tmp_path / "gone.git").as_uri()

    fails(store(tmp_path, arm_from(gone, NOWHERE)), f"git {gone} at 000000000000, arm: fatal: ")


def test_a_commit_that_is_not_there_is_a_failed_source(
    repository: Repository, tmp_path: Path
) -> None:
    publish(repository)

    fails(store(tmp_path, arm_from(repository.url, NOWHERE)), "not our ref")


def test_a_commit_without_the_file_is_a_failed_source(
    repository: Repository, tmp_path: Path
) -> None:
    commit = repository.commit(writing({"arm/other.xml": ARM}))

    fails(store(tmp_path, arm_from(repository.url, commit)), r"has no arm/arm\.xml")


def test_a_link_in_a_repository_is_not_followed(repository: Repository, tmp_path: Path) -> None:
    (tmp_path / "secret").write_bytes(ARM)
    publish(repository)

    def link(tree: Path) -> None:
        (tree / "arm" / "arm.xml").unlink()
        (tree / "arm" / "arm.xml").symlink_to(tmp_path / "secret")

    commit = repository.commit(link)

    fails(store(tmp_path, arm_from(repository.url, commit)), r"arm\.xml has other bytes")


def test_without_git_the_source_is_passed_over(
    repository: Repository, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = store(tmp_path, arm_from(repository.url, publish(repository)))
    monkeypatch.setenv("PATH", str(tmp_path))

    fails(here, "git is not installed")


@pytest.mark.parametrize(
    "wrong",
    [
        {"url": "ext::sh -c touch% evil"},
        {"url": "--upload-pack=evil"},
        {"commit": "main"},
        {"folder": "../elsewhere"},
        {"folder": ""},
    ],
)
def test_a_repository_is_an_address_a_whole_commit_and_a_folder(wrong: dict[str, str]) -> None:
    right = {"kind": "git", "url": "https://example.org/r", "commit": NOWHERE, "folder": "arm"}
    GitSource.model_validate(right)

    with pytest.raises(ValueError, match="pattern"):
        GitSource.model_validate({**right, **wrong})
