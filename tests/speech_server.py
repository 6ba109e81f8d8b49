"""Servers that hear and speak, as well or as badly as they are told: by HTTP and by Wyoming."""

import io
import json
import socketserver
import threading
import wave
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import numpy as np
from guards import HUNG_S
from wyoming.event import Event, read_event, write_event

from edgevox.core.servers.address import Address

TONE = (np.sin(np.arange(8000) / 10) * 8000).astype(np.int16)


def wav_of(samples=TONE, rate_hz: int = 22_050) -> bytes:
    data = io.BytesIO()
    with wave.open(data, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate_hz)
        file.writeframes(samples.tobytes())
    return data.getvalue()


class SpeechRequest:
    """One request to the stand-in, and its answer."""

    def __init__(self, handler: BaseHTTPRequestHandler, body: bytes, over: threading.Event) -> None:
        self._handler = handler
        self.route = handler.path
        self.key = handler.headers["Authorization"]
        self.body = body
        self.over = over

    @property
    def json(self) -> Any:
        return json.loads(self.body)

    @property
    def fields(self) -> dict[str, str]:
        """The fields of a form but its file."""
        mark = self.body.split(b"\r\n", 1)[0]
        found = {}
        for part in self.body.split(mark)[1:-1]:
            head, _, value = part.strip(b"\r\n").partition(b"\r\n\r\n")
            name = head.split(b'name="', 1)[1].split(b'"', 1)[0].decode()
            if b"filename" not in head:
                found[name] = value.decode()
        return found

    @property
    def sound(self) -> wave.Wave_read:
        return wave.open(io.BytesIO(self.body[self.body.index(b"RIFF") :]))

    def reply(self, body: object, code: int = 200, kind: str = "application/json") -> None:
        data = body if isinstance(body, bytes) else json.dumps(body).encode()
        self._handler.send_response(code)
        self._handler.send_header("Content-Type", kind)
        self._handler.end_headers()
        self._handler.wfile.write(data)

    def write(self, data: bytes) -> None:
        """More of the answer, after `reply`."""
        self._handler.wfile.write(data)

    def hang(self) -> None:
        self.over.wait(HUNG_S)


Answer = Callable[[SpeechRequest], None]
MODELS = {"data": [{"id": "qwen3"}, {"id": "Systran/faster-whisper-large-v3"}, {"id": "kokoro"}]}
NOT_FOUND: Answer = lambda one: one.reply({"detail": "Not Found"}, 404)  # noqa: E731


class HttpSpeech:
    """Answers by route; `asked` are the requests that were not only for lists."""

    def __init__(self, answers: dict[str, Answer]) -> None:
        self.answers: dict[str, Answer] = {"/v1/models": lambda one: one.reply(MODELS)} | answers
        self.asked: list[SpeechRequest] = []
        self.over = threading.Event()
        outer = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, *_: object) -> None:
                """Tests have their own."""

            def do_GET(self) -> None:
                self._answer(b"")

            def do_POST(self) -> None:
                self._answer(self.rfile.read(int(self.headers["Content-Length"])))

            def _answer(self, body: bytes) -> None:
                one = SpeechRequest(self, body, outer.over)
                if body:
                    outer.asked.append(one)
                try:
                    outer.answers.get(self.path, NOT_FOUND)(one)
                except OSError:
                    """The client has hung up."""

        self._http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._http.daemon_threads = False
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.01,))
        self._thread.start()

    def address(self, part: str, timeout_s: float = HUNG_S, **more: Any) -> Address:
        url = f"http://127.0.0.1:{self._http.server_port}"
        return Address(url, timeout_s=timeout_s, setting=f"{part}_endpoint", **more)

    def close(self) -> None:
        self.over.set()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()


@contextmanager
def http_speech(**answers: Answer) -> Iterator[HttpSpeech]:
    """A server; `hears`, `speaks`, `models` and `voices` answer their routes."""
    routes = {
        "hears": "/v1/audio/transcriptions",
        "speaks": "/v1/audio/speech",
        "models": "/v1/models",
        "voices": "/v1/audio/voices",
    }
    server = HttpSpeech({routes[name]: answer for name, answer in answers.items()})
    try:
        yield server
    finally:
        server.close()


Turn = Callable[[list[Event], Callable[[Event], None], Any], None]
"""Gets all events of a request, a function that sends one, and the raw stream."""


class WyomingSpeech:
    """Reads a request to its end (`audio-stop`, `synthesize` or `describe`) and answers it."""

    def __init__(self, turn: Turn) -> None:
        self.asked: list[list[Event]] = []
        self.over = threading.Event()
        outer = self

        class Handler(socketserver.StreamRequestHandler):
            def handle(self) -> None:
                events: list[Event] = []
                while event := read_event(self.rfile):
                    events.append(event)
                    if event.type in ("audio-stop", "synthesize", "describe"):
                        break
                outer.asked.append(events)
                try:
                    turn(events, lambda one: write_event(one, self.wfile), self.wfile)
                except OSError:
                    """The client has hung up."""

        self._tcp = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)
        self._tcp.daemon_threads = False
        self._thread = threading.Thread(target=self._tcp.serve_forever, args=(0.01,))
        self._thread.start()

    def address(self, part: str, timeout_s: float = HUNG_S, **more: Any) -> Address:
        url = f"tcp://127.0.0.1:{self._tcp.server_address[1]}"
        return Address(url, timeout_s=timeout_s, setting=f"{part}_endpoint", **more)

    def close(self) -> None:
        self.over.set()
        self._tcp.shutdown()
        self._tcp.server_close()
        self._thread.join()


@contextmanager
def wyoming_speech(turn: Turn) -> Iterator[WyomingSpeech]:
    server = WyomingSpeech(turn)
    try:
        yield server
    finally:
        server.close()
