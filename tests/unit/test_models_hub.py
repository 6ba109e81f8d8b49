"""The hub's own client against a hub on this machine."""

import sys
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest
from models_wheelhouse import CONFIG, VOICE, voice

from edgevox.models.errors import SourceFailed
from edgevox.models.manifest import HubSource
from edgevox.models.progress import Silent
from edgevox.models.sources.hub import Hub

SPEC = HubSource(kind="hub", repo="us/voices", revision="v1", folder="en")
FILES = {
    "/us/voices/resolve/v1/en/voice.onnx": VOICE,
    "/us/voices/resolve/v1/en/voice.json": CONFIG,
}
CLOSED = "http://127.0.0.1:9"


class Counts(Silent):
    def __init__(self) -> None:
        self.counts: list[int] = []

    def at(self, done: int) -> None:
        self.counts.append(done)


class HubHandler(BaseHTTPRequestHandler):
    def do_HEAD(self) -> None:
        self._answer()

    def do_GET(self) -> None:
        data = self._answer()
        self.wfile.write(data)

    def _answer(self) -> bytes:
        data = FILES.get(self.path)
        self.send_response(200 if data else 404)
        if not data:
            self.send_header("X-Error-Code", "EntryNotFound")
        self.send_header("Content-Length", str(len(data or b"")))
        self.send_header("ETag", '"etag"')
        self.send_header("X-Repo-Commit", "c" * 40)
        self.end_headers()
        return data or b""

    def log_message(self, *_: object) -> None: ...


@pytest.fixture
def endpoint() -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), HubHandler) as server:
        thread = Thread(target=server.serve_forever, name="hub")
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def test_files_come_from_the_pinned_revision_of_the_repository(
    endpoint: str, tmp_path: Path
) -> None:
    watched = Counts()

    got = dict(Hub(endpoint).provide(SPEC, voice().files, tmp_path, watched))

    assert [path.read_bytes() for path in got.values()] == [VOICE, CONFIG]
    assert watched.counts[-1] == len(VOICE) + len(CONFIG)


def test_a_file_that_the_repository_lacks_is_a_failed_source(endpoint: str, tmp_path: Path) -> None:
    elsewhere = SPEC.model_copy(update={"folder": "fr"})

    with pytest.raises(SourceFailed, match="404"):
        list(Hub(endpoint).provide(elsewhere, voice().files, tmp_path, Silent()))


def test_a_hub_out_of_reach_is_asked_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hub = Hub(CLOSED)
    with pytest.raises(SourceFailed, match="cannot be reached"):
        list(hub.provide(SPEC, voice().files, tmp_path, Silent()))
    monkeypatch.setattr("huggingface_hub.utils.get_session", lambda: pytest.fail("asked again"))

    with pytest.raises(SourceFailed, match="cannot be reached"):
        list(hub.provide(SPEC, voice().files, tmp_path, Silent()))


def test_without_the_client_the_hub_is_passed_over_with_a_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "huggingface_hub", None)

    with pytest.raises(SourceFailed, match=r"edgevox\[models\]"):
        list(Hub().provide(SPEC, voice().files, tmp_path, Silent()))
