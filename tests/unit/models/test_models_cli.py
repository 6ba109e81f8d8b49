import io
from pathlib import Path

import pytest
from models_wheelhouse import CONFIG, VOICE, chat, manifest, voice
from support.clock import HeldClock

from edgevox.apps.models import main
from edgevox.models.fetch_progress import ProgressLines, shown_on

MANIFEST = manifest(voice(), chat())


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A store with the voice in it."""
    (tmp_path / "voice").mkdir()
    (tmp_path / "voice" / "voice.onnx").write_bytes(VOICE)
    (tmp_path / "voice" / "voice.json").write_bytes(CONFIG)
    return tmp_path


def run(root: Path, *arguments: str) -> int:
    return main(["--dir", str(root), *arguments], MANIFEST)


def test_list_says_what_is_here(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(root, "list") == 0

    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "both: 0.0 MB, 1 of 2 here"
    assert next(line for line in lines if line.startswith("  voice")).endswith("here     MIT")
    assert next(line for line in lines if line.startswith("  chat")).endswith("missing  MIT")


def test_list_says_what_a_licence_forbids_and_tells_a_model_once(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--dir", str(root), "list"]) == 0

    lines = capsys.readouterr().out.splitlines()
    wake_words = next(line for line in lines if line.startswith("  wake-words"))
    assert wake_words.endswith("CC-BY-NC-SA-4.0, not for commercial use")
    assert "  franka-panda (see above)" in lines
    told = [line for line in lines if line.startswith("  franka-panda ")]
    assert len(told) == 2


def test_list_tells_models_of_no_set_too(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    alone = MANIFEST.model_copy(update={"sets": {"voices": ("voice",)}})

    assert main(["--dir", str(root), "list"], alone) == 0

    assert "in no set: 0.0 MB, 0 of 1 here\n  chat " in capsys.readouterr().out


def test_path_prints_the_entry_file(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(root, "path", "voice") == 0
    assert capsys.readouterr().out == f"{root}/voice/voice.onnx\n"


def test_path_of_a_missing_model_fails_with_the_command_that_helps(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(root, "path", "chat") == 1
    assert "edgevox-models fetch chat" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [("fetch", "vioce"), ("path", "vioce"), ("path", "both")])
def test_an_unknown_name_is_a_usage_error(
    root: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]
) -> None:
    assert run(root, *arguments) == 2
    assert "one of " in capsys.readouterr().err


def test_an_unknown_command_is_a_usage_error(root: Path) -> None:
    with pytest.raises(SystemExit) as ended:
        run(root, "steal")
    assert ended.value.code == 2


def test_fetch_of_what_is_here_needs_no_network(root: Path) -> None:
    assert run(root, "fetch", "--offline", "voice") == 0


def test_fetch_offline_of_what_is_missing_fails_saying_so(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(root, "fetch", "--offline", "both") == 1
    assert "--offline forbids" in capsys.readouterr().err


def test_verify_finds_a_damaged_file(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(root, "verify") == 0
    (root / "voice" / "voice.json").write_bytes(CONFIG.swapcase())

    assert run(root, "verify") == 1
    assert "voice.json is missing or damaged" in capsys.readouterr().out


def test_verify_of_nothing_at_all_is_a_failure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, "verify") == 1
    assert f"there is no model in {tmp_path}" in capsys.readouterr().err


def test_models_come_from_a_folder_without_the_network(root: Path, tmp_path: Path) -> None:
    place = tmp_path / "robot"

    assert run(place, "fetch", "--offline", "--from", str(root), "voice") == 0

    assert (place / "voice" / "voice.onnx").read_bytes() == VOICE
    assert run(place, "verify") == 0
    assert not (place / "voice" / ".partial").exists()


@pytest.mark.parametrize("damage", [CONFIG.swapcase(), CONFIG[:-1], None])
def test_a_folder_with_a_bad_file_gives_nothing_and_what_was_there_stays(
    root: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: bytes | None
) -> None:
    place = tmp_path / "robot"
    (place / "voice").mkdir(parents=True)
    (place / "voice" / "voice.onnx").write_bytes(b"the old one")
    bad = root / "voice" / "voice.json"
    bad.unlink() if damage is None else bad.write_bytes(damage)

    assert run(place, "fetch", "--offline", "--from", str(root), "voice") == 1

    assert f"folder {root}/voice: voice.json is missing or damaged" in capsys.readouterr().err
    assert (place / "voice" / "voice.onnx").read_bytes() == b"the old one"
    assert [path.name for path in (place / "voice").iterdir()] == ["voice.onnx"]


def test_a_folder_that_is_not_there_is_told(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(root, "fetch", "--from", "/not/there", "chat") == 1
    assert "/not/there" in capsys.readouterr().err


def test_licences_say_what_they_forbid(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--dir", str(root), "licences"]) == 0

    out = capsys.readouterr().out
    assert "Not for commercial use." in out.partition("wake-words")[2].partition("qwen")[0]
    assert "lessac" in out


def test_without_a_terminal_progress_is_a_line_now_and_then() -> None:
    out, watch = io.StringIO(), HeldClock()
    lines = ProgressLines(out, watch, every_s=5.0)

    lines.begin("chat", 100_000_000)
    for second in range(11):
        watch.now_s = float(second)
        lines.at(second * 9_000_000)
    lines.end()

    assert out.getvalue().splitlines() == [
        "chat: fetching 100 MB",
        "chat: 45 MB of 100 MB",
        "chat: 90 MB of 100 MB",
        "chat: there after 10 s",
    ]


def test_on_a_terminal_progress_is_a_bar_with_name_size_and_speed() -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    out = Terminal()
    with shown_on(out) as progress:
        progress.begin("chat", 2_000_000)
        progress.at(1_000_000)
        progress.end()

    assert "chat" in out.getvalue()
    assert "2.0/2.0 MB" in out.getvalue()
