"""What a robot keeps goes to another computer, and nothing else does."""

import io
import json
import stat
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest
from guards import HUNG_S

from edgevox.apps.edgevox import main
from edgevox.apps.state import ABOUT, MOST_BYTES, read
from edgevox.core.errors import EdgeVoxError


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Make this process one robot's, by its name."""

    def robot(name: str) -> Path:
        monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / name))
        return tmp_path / name / "edgevox"

    return robot


KEPT = {
    "robot-apartment.yaml": "places: {}\n",
    "console/ca.key": "secret\n",
    "console/sessions/anna.json": "{}\n",
}


def taught(folder: Path) -> None:
    left = {"console/recordings/edgevox-1/a.mcap": "large", "voiceprints/anna.json": "[1]\n"}
    for name, text in {**KEPT, **left}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def files_of(folder: Path) -> dict[str, str]:
    return {
        str(file.relative_to(folder)): file.read_text()
        for file in folder.rglob("*")
        if file.is_file()
    }


def test_a_new_computer_has_what_the_old_one_kept_but_for_recordings_and_voices(
    robot, tmp_path
) -> None:
    taught(robot("old"))
    archive = tmp_path / "robot.tar"
    assert main(["state", "export", str(archive)]) == 0
    assert stat.S_IMODE(archive.stat().st_mode) == 0o600
    new = robot("new")
    assert main(["state", "import", str(archive)]) == 0
    assert files_of(new) == KEPT
    for file in new.rglob("*.*"):
        assert stat.S_IMODE(file.stat().st_mode) == 0o600


def test_a_file_that_a_shell_makes_of_the_output_is_its_owners_alone(robot, tmp_path) -> None:
    taught(robot("old"))
    archive = tmp_path / "robot.tar"
    with archive.open("wb") as output:
        archive.chmod(0o644)
        command = [sys.executable, "-m", "edgevox.apps.edgevox", "state", "export", "-"]
        subprocess.run(command, stdout=output, check=True, timeout=HUNG_S)
    assert stat.S_IMODE(archive.stat().st_mode) == 0o600
    with archive.open("rb") as written:
        assert len(read(written)) == len(KEPT)


def test_both_name_the_folders_since_a_wrong_one_is_lost_with_its_container(
    robot, tmp_path, capsys
) -> None:
    taught(robot("old"))
    archive = tmp_path / "robot.tar"
    assert main(["state", "export", str(archive)]) == 0
    said = "files: 1 in {0}, 2 in {0}/console"
    assert said.format(tmp_path / "old/edgevox") in capsys.readouterr().err
    robot("new")
    assert main(["state", "import", str(archive)]) == 0
    assert said.format(tmp_path / "new/edgevox") in capsys.readouterr().out


def test_nothing_is_overwritten_unless_that_is_asked_for(robot, tmp_path, capsys) -> None:
    taught(robot("old"))
    archive = tmp_path / "robot.tar"
    assert main(["state", "export", str(archive)]) == 0
    assert main(["state", "export", str(archive)]) == 1
    new = robot("new")
    new.mkdir(parents=True)
    (new / "robot-apartment.yaml").write_text("mine")
    assert main(["state", "import", str(archive)]) == 1
    assert "robot-apartment.yaml: is there already; --replace" in capsys.readouterr().err
    assert files_of(new) == {"robot-apartment.yaml": "mine"}
    assert main(["state", "import", "--replace", str(archive)]) == 0
    assert files_of(new) == KEPT


def archive_of(files: dict[str, bytes], kind: bytes = tarfile.REGTYPE) -> io.BytesIO:
    made = io.BytesIO()
    with tarfile.open(fileobj=made, mode="w") as tar:
        for name, data in files.items():
            member = tarfile.TarInfo(name)
            member.size, member.type = len(data), kind if name != ABOUT else tarfile.REGTYPE
            tar.addfile(member, io.BytesIO(data))
    made.seek(0)
    return made


ABOUT_IT = {ABOUT: json.dumps({"format": 1}).encode()}


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({}, "expected an archive of"),
        ({ABOUT: b'{"format": 2}'}, "format 2: expected 1"),
        ({**ABOUT_IT, "/etc/passwd": b""}, "expected a file within the archive"),
        ({**ABOUT_IT, "places/../../x": b""}, "expected a file within the archive"),
        ({**ABOUT_IT, "models/x": b""}, "expected a file in places/ or console/"),
        ({**ABOUT_IT, "places/x": b"\xff"}, "expected text in UTF-8"),
        ({**ABOUT_IT, "places/x": bytes(MOST_BYTES)}, "expected at most"),
    ],
)
def test_what_is_no_such_archive_is_refused(files: dict[str, bytes], said: str) -> None:
    with pytest.raises(EdgeVoxError, match=said):
        read(archive_of(files))


def test_a_link_in_it_is_refused() -> None:
    with pytest.raises(EdgeVoxError, match="expected a file within"):
        read(archive_of({**ABOUT_IT, "places/x": b""}, tarfile.SYMTYPE))
