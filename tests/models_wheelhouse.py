"""Small models in real wheels, in a folder that pip takes for its index, or a stand-in for pip."""

import hashlib
import shutil
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from edgevox.models.fetch_progress import SilentProgress
from edgevox.models.manifest import Manifest, Model
from edgevox.models.sources import wheel
from edgevox.models.store import SourceFailed, Store

VOICE = b"the voice" * 1000
CONFIG = b'{"rate": 22050}'
CHAT_PARTS = (b"a" * 5000, b"b" * 5000, b"c" * 700)
CHAT = b"".join(CHAT_PARTS)

VOICE_WHEEL = {"kind": "wheel", "package": "tiny-voice", "version": "1.0", "folder": "tv/data"}
CHAT_WHEELS = {
    "kind": "wheel",
    "package": "tiny-chat-{n}",
    "version": "2.0",
    "member": "tm_{n}/part{n:02}.bin",
    "parts": len(CHAT_PARTS),
}


def entry(name: str, data: bytes) -> dict[str, Any]:
    return {"name": name, "size": len(data), "sha256": hashlib.sha256(data).hexdigest()}


def model(name: str, files: list[dict[str, Any]], *sources: Mapping[str, Any]) -> Model:
    facts = {"id": name, "title": name, "publisher": "us", "copyright": "(c) us", "licence": "MIT"}
    entry_file = files[0]["name"]
    return Model.model_validate({**facts, "entry": entry_file, "files": files, "sources": sources})


def voice(*sources: Mapping[str, Any]) -> Model:
    files = [entry("voice.onnx", VOICE), entry("voice.json", CONFIG)]
    return model("voice", files, *(sources or (VOICE_WHEEL,)))


def chat() -> Model:
    return model("chat", [entry("chat.gguf", CHAT)], CHAT_WHEELS)


def manifest(*models: Model) -> Manifest:
    mit = {"name": "MIT License", "url": "https://example.org/mit", "commercial_use": True}
    by_id = {one.id: one for one in models}
    return Manifest(licences={"MIT": mit}, sets={"both": tuple(by_id)}, models=by_id)


def store(root: Path, *models: Model) -> Store:
    return Store(root / "models", manifest(*models))


class Wheelhouse:
    """A folder of wheels."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()

    def add(self, package: str, version: str, members: Mapping[str, bytes]) -> Path:
        name = f"{package.replace('-', '_')}-{version}"
        path = self.folder / f"{name}-py3-none-any.whl"
        about = f"Metadata-Version: 2.1\nName: {package}\nVersion: {version}\n"
        kind = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for member, data in members.items():
                archive.writestr(member, data)
            archive.writestr(f"{name}.dist-info/METADATA", about)
            archive.writestr(f"{name}.dist-info/WHEEL", kind)
            archive.writestr(f"{name}.dist-info/RECORD", "")
        return path

    def add_voice(self, data: bytes = VOICE, package: str = "tiny-voice") -> Path:
        return self.add(package, "1.0", {"tv/data/voice.onnx": data, "tv/data/voice.json": CONFIG})

    def add_chat(self, *parts: int) -> None:
        for n in parts:
            self.add(f"tiny-chat-{n}", "2.0", {f"tm_{n}/part{n:02}.bin": CHAT_PARTS[n - 1]})

    def download(
        self, requirement: str, _platform: str, into: Path, share: Callable[[float], None]
    ) -> Path:
        """Does what pip does, as far as fetching sees it, without half a second of pip."""
        package, _, version = requirement.partition("==")
        path = self.folder / f"{package.replace('-', '_')}-{version}-py3-none-any.whl"
        if not path.exists():
            raise SourceFailed(f"no matching distribution found for {requirement}")
        share(1.0)
        return Path(shutil.copy(path, into))

    def empty(self) -> None:
        for path in self.folder.iterdir():
            path.unlink()


def shelf(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    """A wheelhouse whose wheels are taken from it without pip."""
    house = Wheelhouse(folder)
    monkeypatch.setattr(wheel, "download_wheel", house.download)
    monkeypatch.delenv("EDGEVOX_OFFLINE", raising=False)
    return house


def wheelhouse(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    """A wheelhouse that pip takes for its only index."""
    house = Wheelhouse(folder)
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(house.folder))
    monkeypatch.delenv("EDGEVOX_OFFLINE", raising=False)
    return house


class Counts(SilentProgress):
    """Keeps how far a fetch said that it was."""

    def __init__(self) -> None:
        self.counts: list[int] = []

    def at(self, done: int) -> None:
        self.counts.append(done)
