"""The hub's own client against a hub on this machine."""

import os
import subprocess
import sys
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import ClassVar

import pytest
from models_sources import CLOSED, serving
from models_wheelhouse import CONFIG, VOICE, Counts, store, voice

from edgevox.models import FetchFailed, Store, fetch
from edgevox.models.fetch_progress import SilentProgress
from edgevox.models.manifest import HubSource
from edgevox.models.sources.hub import Hub
from edgevox.models.store import SourceFailed

SPEC = HubSource(kind="hub", repo="us/voices", revision="v1", folder="en")
FILES = {
    "/us/voices/resolve/v1/en/voice.onnx": VOICE,
    "/us/voices/resolve/v1/en/voice.json": CONFIG,
}


class HubHandler(BaseHTTPRequestHandler):
    """Speaks as much of the hub's protocol as its client asks for."""

    files: ClassVar[dict[str, bytes]] = FILES
    stops_after: ClassVar[int | None] = None
    """Bytes of a file after which the connection is cut; None sends all of it."""

    def do_HEAD(self) -> None:
        self._answer()

    def do_GET(self) -> None:
        data = self._answer()
        self.wfile.write(data[: self.stops_after])

    def _answer(self) -> bytes:
        data = self.files.get(self.path)
        self.send_response(200 if data else 404)
        if not data:
            self.send_header("X-Error-Code", "EntryNotFound")
        self.send_header("Content-Length", str(len(data or b"")))
        self.send_header("ETag", '"etag"')
        self.send_header("X-Repo-Commit", "c" * 40)
        self.end_headers()
        return data or b""

    def log_message(self, *_: object) -> None: ...


def hub_with(files: dict[str, bytes], stops_after: int | None = None) -> type[HubHandler]:
    return type("Hub", (HubHandler,), {"files": files, "stops_after": stops_after})


@pytest.fixture
def endpoint() -> Iterator[str]:
    with serving(HubHandler) as address:
        yield address


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
        list(Hub(endpoint).provide(elsewhere, voice().files, tmp_path, SilentProgress()))


def test_a_hub_out_of_reach_is_asked_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hub = Hub(CLOSED)
    with pytest.raises(SourceFailed, match="cannot be reached"):
        list(hub.provide(SPEC, voice().files, tmp_path, SilentProgress()))
    monkeypatch.setattr("huggingface_hub.utils.get_session", lambda: pytest.fail("asked again"))

    with pytest.raises(SourceFailed, match="cannot be reached"):
        list(hub.provide(SPEC, voice().files, tmp_path, SilentProgress()))


def test_without_the_client_the_hub_is_passed_over_with_a_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "huggingface_hub", None)

    with pytest.raises(SourceFailed, match=r"pip install .\.\[models\]. in EdgeVox's"):
        list(Hub().provide(SPEC, voice().files, tmp_path, SilentProgress()))


def fetch_from(hub: type[HubHandler], here: Store) -> Path:
    with serving(hub) as address:
        (path,) = fetch(["voice"], store=here, offline=False, providers={HubSource: Hub(address)})
    return path


@pytest.fixture
def here(tmp_path: Path) -> Store:
    return store(tmp_path, voice(SPEC.model_dump()))


def test_a_model_comes_whole_from_the_hub(here: Store) -> None:
    path = fetch_from(HubHandler, here)

    assert path.read_bytes() == VOICE
    assert not (path.parent / ".partial").exists()


@pytest.mark.parametrize(
    "wrong", [VOICE.swapcase(), VOICE[:-9], VOICE + b"more"], ids=["other", "shorter", "longer"]
)
def test_other_bytes_from_the_hub_are_never_installed(here: Store, wrong: bytes) -> None:
    files = {path: wrong if data is VOICE else data for path, data in FILES.items()}

    with pytest.raises(FetchFailed, match=r"voice\.onnx has other bytes"):
        fetch_from(hub_with(files), here)

    assert not (here.root / "voice" / "voice.onnx").exists()


def test_a_connection_that_breaks_leaves_nothing_half_and_the_next_fetch_goes_on(
    here: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The client's patience between its tries: this hub does not get better meanwhile.
    monkeypatch.setattr("huggingface_hub.file_download.time.sleep", lambda _: None)
    with pytest.raises(FetchFailed, match="hub us/voices at v1: "):
        fetch_from(hub_with(FILES, stops_after=100), here)
    assert not (here.root / "voice" / "voice.onnx").exists()

    assert fetch_from(HubHandler, here).read_bytes() == VOICE


def test_what_came_before_the_hub_died_is_not_asked_for_again(here: Store) -> None:
    first, second = FILES
    with pytest.raises(FetchFailed, match="404"):
        fetch_from(hub_with({first: FILES[first]}), here)

    fetch_from(hub_with({second: FILES[second]}), here)

    assert not here.missing(voice())


def test_a_dead_hub_is_named_with_its_repository(here: Store) -> None:
    with pytest.raises(FetchFailed, match="hub us/voices at v1: the hub cannot be reached"):
        fetch(["voice"], store=here, offline=False, providers={HubSource: Hub(CLOSED)})


def test_the_environment_says_where_the_hub_is(endpoint: str, tmp_path: Path) -> None:
    program = (
        "import sys; sys.path[:0] = sys.argv[2:]\n"
        "from pathlib import Path; from models_wheelhouse import store, voice\n"
        "from edgevox.models import fetch; from test_models_hub import SPEC\n"
        "fetch(['voice'], store=store(Path(sys.argv[1]), voice(SPEC.model_dump())))"
    )
    environment = {**os.environ, "HF_ENDPOINT": endpoint, "EDGEVOX_OFFLINE": ""}

    folders = map(str, Path(__file__).parents[:3])

    subprocess.run(
        [sys.executable, "-c", program, str(tmp_path), *folders],
        env=environment,
        check=True,
    )

    assert (tmp_path / "models" / "voice" / "voice.onnx").read_bytes() == VOICE
