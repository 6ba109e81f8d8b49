import hashlib
import os
from pathlib import Path

import pytest
from models_wheelhouse import CONFIG, VOICE, VOICE_WHEEL, chat, entry, model, store, voice

from edgevox.models import ModelMissing, Store, UnknownModel
from edgevox.models.manifest import Manifest, ModelFile, builtin_manifest
from edgevox.models.store import default_root


@pytest.fixture
def here(tmp_path: Path) -> Store:
    """A store with the voice in it, put there by hand."""
    place = store(tmp_path, voice(), chat())
    folder = place.root / "voice"
    folder.mkdir(parents=True)
    (folder / "voice.onnx").write_bytes(VOICE)
    (folder / "voice.json").write_bytes(CONFIG)
    return place


def count_hashing(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    hashed: list[str] = []
    real = hashlib.file_digest

    def counting(stream: object, name: str) -> object:
        hashed.append(Path(stream.name).name)  # type: ignore[attr-defined]
        return real(stream, name)  # type: ignore[arg-type]

    monkeypatch.setattr(hashlib, "file_digest", counting)
    return hashed


def test_a_model_put_there_by_hand_is_found(here: Store) -> None:
    assert here.locate("voice") == here.root / "voice" / "voice.onnx"


def test_a_missing_model_names_the_command_that_fetches_it(here: Store) -> None:
    with pytest.raises(ModelMissing, match="edgevox-models fetch chat"):
        here.locate("chat")


def test_a_model_without_an_entry_file_is_its_folder(tmp_path: Path) -> None:
    assert builtin_manifest().models["whisper-tiny.en"].entry == ""


def test_an_unknown_model_is_refused(here: Store) -> None:
    with pytest.raises(UnknownModel, match="one of both, voice, chat"):
        here.locate("hearing")


def test_bytes_are_hashed_once(here: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    hashed = count_hashing(monkeypatch)

    here.locate("voice")
    here.locate("voice")

    assert sorted(hashed) == ["voice.json", "voice.onnx"]


def test_a_file_that_was_touched_is_hashed_again(
    here: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = here.locate("voice")
    hashed = count_hashing(monkeypatch)
    os.utime(path, (1, 1))

    here.locate("voice")

    assert hashed == ["voice.onnx"]


def test_a_file_of_the_right_size_with_other_bytes_counts_as_missing(here: Store) -> None:
    (here.root / "voice" / "voice.onnx").write_bytes(VOICE.swapcase())

    with pytest.raises(ModelMissing, match=r"voice\.onnx"):
        here.locate("voice")


def test_verify_finds_damage_that_kept_size_and_time(here: Store) -> None:
    path = here.locate("voice")
    seen = path.stat()
    path.write_bytes(VOICE.swapcase())
    os.utime(path, ns=(seen.st_atime_ns, seen.st_mtime_ns))

    wrong = here.verify(here.manifest.models["voice"])

    assert [file.name for file in wrong] == ["voice.onnx"]
    with pytest.raises(ModelMissing):
        here.locate("voice")


def test_verify_names_what_is_damaged_where_no_stamp_can_be_dropped(here: Store) -> None:
    (here.root / "voice" / ".verified.json").mkdir()
    (here.root / "voice" / "voice.onnx").write_bytes(VOICE.swapcase())

    wrong = here.verify(here.manifest.models["voice"])

    assert [file.name for file in wrong] == ["voice.onnx"]


def test_a_broken_stamp_file_only_costs_a_hash(here: Store) -> None:
    path = here.locate("voice")
    path.with_name(".verified.json").write_text("[not json")

    assert here.locate("voice") == path


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"EDGEVOX_MODELS_DIR": "/data/models"}, "/data/models"),
        ({"XDG_CACHE_HOME": "/var/cache/me"}, "/var/cache/me/edgevox/models"),
        ({}, "~/.cache/edgevox/models"),
        ({"EDGEVOX_MODELS_DIR": "", "XDG_CACHE_HOME": ""}, "~/.cache/edgevox/models"),
    ],
)
def test_the_default_folder_follows_the_environment(
    environment: dict[str, str], expected: str
) -> None:
    assert default_root(environment) == Path(expected).expanduser()


ROBOT = model("robot", [entry("arm.xml", b"<x/>"), entry("assets/a.obj", b"v 0")], VOICE_WHEEL)


def test_files_in_folders_are_found_and_stamped(tmp_path: Path) -> None:
    place = store(tmp_path, ROBOT)
    (place.root / "robot" / "assets").mkdir(parents=True)
    (place.root / "robot" / "arm.xml").write_bytes(b"<x/>")
    assert [file.name for file in place.missing(ROBOT)] == ["assets/a.obj"]

    (place.root / "robot" / "assets" / "a.obj").write_bytes(b"v 0")

    assert place.locate("robot") == place.root / "robot" / "arm.xml"
    assert "assets/a.obj" in (place.root / "robot" / ".verified.json").read_text()


def test_a_file_is_put_into_its_folder(tmp_path: Path) -> None:
    place = store(tmp_path, ROBOT)
    (tmp_path / "fetched").write_bytes(b"v 0")

    place.adopt(ROBOT, ROBOT.files[1], tmp_path / "fetched")

    assert (place.root / "robot" / "assets" / "a.obj").read_bytes() == b"v 0"


def test_a_licence_that_a_model_brings_along_is_the_one_in_its_notice(tmp_path: Path) -> None:
    own = {"files": (*ROBOT.files, ModelFile(**entry("LICENSE", b"Ask us."))), "licence": "MIT"}
    robot = ROBOT.model_copy(update={**own, "licence_file": "LICENSE"})
    place = store(tmp_path, robot)
    (place.root / "robot").mkdir(parents=True)
    (place.root / "robot" / "LICENSE").write_bytes(b"Ask us.")

    place.finish(robot)

    notice = (place.root / "robot" / "LICENCE.txt").read_text()
    assert notice.endswith("Ask us.")
    assert "Permission is hereby granted" not in notice


def test_all_licences_of_a_model_are_in_its_notice(tmp_path: Path) -> None:
    robot = ROBOT.model_copy(update={"further_licences": ("Apache-2.0",)})
    described = builtin_manifest().licences
    place = Store(tmp_path, Manifest(licences=described, sets={}, models={"robot": robot}))
    (tmp_path / "robot").mkdir()

    place.finish(robot)

    notice = (tmp_path / "robot" / "LICENCE.txt").read_text()
    assert "Permission is hereby granted" in notice
    assert "Apache License" in notice


def test_a_file_that_vanishes_while_it_is_looked_at_counts_as_missing(
    here: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    (voice_model,) = here.manifest.select(["voice"])
    here.locate("voice")  # its stamps are fresh
    look = Path.stat

    def look_and_lose(path: Path, **options: bool) -> os.stat_result:
        seen = look(path, **options)
        if path.name == "voice.onnx":
            path.unlink()
        return seen

    monkeypatch.setattr(Path, "stat", look_and_lose)
    here.missing(voice_model)  # seen a moment ago: either answer is true

    assert [file.name for file in here.missing(voice_model)] == ["voice.onnx"]


def test_a_file_that_vanishes_before_it_is_hashed_counts_as_missing(
    here: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    (voice_model,) = here.manifest.select(["voice"])
    opened = Path.open

    def lost(path: Path, *how: str, **options: str) -> object:
        if path.name == "voice.onnx":
            path.unlink(missing_ok=True)
        return opened(path, *how, **options)  # type: ignore[call-overload]

    monkeypatch.setattr(Path, "open", lost)

    assert [file.name for file in here.missing(voice_model)] == ["voice.onnx"]
