"""One archive for support: what it tells, and that no secret is in it."""

import gzip
import io
import json
import re
import stat
import tarfile
from pathlib import Path

import pytest

from edgevox import __version__
from edgevox.apps.doctor import bundle as bundled
from edgevox.apps.doctor.bundle import REMOVED, Redaction, without_speech
from edgevox.apps.edgevox import main
from edgevox.core.probe import ProbeFailed
from edgevox.core.settings import Settings
from edgevox.core.status import Components, Status
from edgevox.ops.health import Health, HealthServer

PEM = (
    "-----BEGIN PRIVATE KEY-----\nMIIEvgIBADANBgkqhkiG9w0BAQ\nMIIESCBKgwggSk\n"
    "-----END PRIVATE KEY-----"
)
PLANTED = {
    "EDGEVOX_LLM_API_KEY": "sk-planted-variable",
    "AWS_SECRET_ACCESS_KEY": "planted/aws+secret",
    "EDGEVOX_PASWORT": "planted-misspelled",
}
LINES = [
    "Authorization: Bearer planted-bearer-0001",
    '{"event": "request", "headers": {"Authorization": "Basic planted-basic="}}',
    r'{"event": "library", "body": "{\"password\": \"planted, with blank\"}"}',
    'password="planted \\" quoted" and more',
    "api_key=planted-plain-key;next=1",
    "proxy http://robot:planted-in-url@proxy.lan:3128/",
    "Set-Cookie: edgevox=planted-cookie; HttpOnly",
    "https://robot1.local:8443/#pair=PLANTEDQ",
    "code PLAN-TEDX, once, as operator, for ten minutes",
    "AKIAPLANTEDPLANTED01",
    "eyJplantedplanted.planted.planted",
    *("edgevox-ros2-1  | " + line for line in PEM.replace("MIIE", "planted").splitlines()),
    "variable sk-planted-variable in another sentence",
]


@pytest.fixture
def _no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(_address: str) -> None:
        raise ProbeFailed("no ROS 2 here")

    monkeypatch.setattr(bundled, "probe_apart", lost)


def written(tmp_path: Path, *more: str) -> dict[str, str]:
    archive = tmp_path / "support.tar.gz"
    assert main(["doctor", "--only", "python", "--bundle", str(archive), *more]) == 0
    assert stat.S_IMODE(archive.stat().st_mode) == 0o600
    with tarfile.open(archive) as tar:
        return {one.name: tar.extractfile(one).read().decode() for one in tar}


@pytest.mark.usefixtures("_no_ros")
def test_no_secret_is_in_it(tmp_path, monkeypatch) -> None:
    keys = [name for name in Settings.model_fields if name.endswith("_key_file")]
    assert len(keys) >= 3
    for name in keys:
        key = tmp_path / name
        key.write_text(f"{name}-planted\n")
        monkeypatch.setenv(f"EDGEVOX_{name.upper()}", str(key))
    log = tmp_path / "edgevox.log"
    log.write_text(
        "\n".join([*LINES, *(f"it holds {one}-planted" for one in keys), "the last line"])
    )
    for name, value in PLANTED.items():
        monkeypatch.setenv(name, value)
    files = written(tmp_path, "--logs", str(log))
    for name, text in files.items():
        assert not re.search("planted(?!-misspelled)", text, re.IGNORECASE), (name, text)
        if name.endswith(".json"):
            json.loads(text)
    assert files["log.txt"].endswith("the last line")
    assert str(key) in files["settings.json"], "where the key is, is no secret"
    assert json.loads(files["environment.json"])["EDGEVOX_PASWORT"] == REMOVED
    assert "AWS_SECRET_ACCESS_KEY" not in files["environment.json"]


@pytest.mark.usefixtures("_no_ros")
def test_it_tells_what_runs_and_how_it_is(tmp_path, monkeypatch) -> None:
    class Part:
        name, checks = "sim", ()

        def status(self) -> Status:
            return Status.judged("sim", battery=0.5)

    server = HealthServer(Health(Components(Part())), "127.0.0.1", 0)
    server.start()
    monkeypatch.setenv("EDGEVOX_HEALTH_PORT", str(server.port))
    monkeypatch.setenv("EDGEVOX_LANGUAGE", "de")
    try:
        files = written(tmp_path)
    finally:
        server.close()
    assert json.loads(files["about.json"])["version"] == __version__
    assert json.loads(files["settings.json"])["language"] == "de"
    assert json.loads(files["environment.json"])["EDGEVOX_LANGUAGE"] == "de"
    assert json.loads(files["doctor.json"])["checks"][0]["check"] == "python"
    health = json.loads(files["health.json"])
    assert health["/live"]["status"] == "ok"
    assert health["/status"]["components"][0]["values"] == {"battery": 0.5}
    assert "pydantic==" in files["packages.txt"]
    assert "no ROS 2 here" in files["graph.json"]
    assert "log.txt" not in files


@pytest.mark.usefixtures("_no_ros")
def test_it_is_written_where_the_settings_are_refused_and_nothing_runs(
    tmp_path, monkeypatch
) -> None:
    monkeypatch.setenv("EDGEVOX_LANGUAGE", "klingon")
    assert "klingon" in json.loads(written(tmp_path)["settings.json"])["refused"]


@pytest.mark.usefixtures("_no_ros")
@pytest.mark.parametrize("more", [["--bundle", "there"], ["--bundle", "new", "--logs", "gone"]])
def test_what_cannot_be_written_or_read_is_one_line_and_nothing_is_overwritten(
    tmp_path, monkeypatch, capsys, more
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there").write_text("mine", encoding="utf-8")
    assert main(["doctor", "--only", "python", *more]) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert Path("there").read_text(encoding="utf-8") == "mine"
    assert not Path("new").exists()


def test_a_secret_is_removed_however_json_writes_it() -> None:
    redacted = Redaction(['a"b\\c-long', "abc"])
    assert redacted(json.dumps({"x": 'a"b\\c-long'})) == json.dumps({"x": REMOVED})
    assert redacted("abc") == "abc", "too short to be told from other words"


def test_what_is_no_secret_stays() -> None:
    text = "edgevox_llm_tokens_total 53\nllm_endpoint_key_file=/run/secrets/key\nkey ok, code 64\n"
    assert Redaction([])(text) == text


def test_what_people_said_is_told_as_its_length() -> None:
    line = 'edgevox-ros2-1  | {"event": "turn_began", "turn": 1, "text": "my name is Anna"}\n'
    assert without_speech(line) == line.replace("my name is Anna", "<15 characters>")
    call = {"event": "skill_called", "arguments": {"name": "Anna's desk", "distance_m": 2.0}}
    assert json.loads(without_speech(json.dumps(call)))["arguments"] == {
        "name": "<11 characters>",
        "distance_m": 2.0,
    }
    held = '{"event": "answered", "text": "<15 characters>"}\n'
    assert without_speech(held) == held
    assert without_speech("no JSON {at all\n") == "no JSON {at all\n"


@pytest.mark.usefixtures("_no_ros")
def test_only_the_last_of_a_long_log_is_taken(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(bundled, "MOST_LOG_BYTES", 20)
    log = tmp_path / "edgevox.log"
    log.write_bytes(b"first line\nsecond line\nthird \xff\n")
    assert (
        written(tmp_path, "--logs", str(log))["log.txt"]
        == "second line\nthird \N{REPLACEMENT CHARACTER}\n"
    )


@pytest.mark.usefixtures("_no_ros")
def test_it_goes_to_the_output_and_the_log_comes_from_the_input(monkeypatch, capfdbinary) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"one line\n"), encoding="utf-8"))
    assert main(["doctor", "--only", "python", "--bundle", "-", "--logs", "-"]) == 0
    with tarfile.open(fileobj=io.BytesIO(gzip.decompress(capfdbinary.readouterr().out))) as tar:
        assert tar.extractfile("log.txt").read() == b"one line\n"
