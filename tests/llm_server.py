"""A server that speaks the OpenAI protocol over real HTTP, as well or as badly as it is told."""

import json
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from guards import HUNG_S

from edgevox.agent.llm.language_model import ChatMessage
from edgevox.agent.llm.remote_model import PAUSES_S, EndpointModel
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.settings import GrammarDialect

CHAT = [ChatMessage("system", "Be brief."), ChatMessage("user", "Where to?")]
ROOMS = 'root ::= "go " ("kitchen" | "bedroom") "!"'
Chat = Callable[["Reply"], None]
AT_ONCE_S = [0.0 for _ in PAUSES_S]
"""What answers has so long, on whatever machine; shorter where silence is the subject."""


class Reply:
    """What a server may do about one request for a chat."""

    def __init__(self, handler: BaseHTTPRequestHandler, over: threading.Event) -> None:
        self._handler = handler
        self.over = over

    def status(self, code: int, body: str = "", **headers: str) -> None:
        self._handler.send_response(code)
        for name, value in headers.items():
            self._handler.send_header(name.replace("_", "-"), value)
        self._handler.end_headers()
        self.raw(body)

    def stream(self) -> None:
        self.status(200, Content_Type="text/event-stream")

    def raw(self, text: str | bytes) -> None:
        self._handler.wfile.write(text.encode() if isinstance(text, str) else text)
        self._handler.wfile.flush()

    def piece(self, text: str | None, finish: str | None = None) -> None:
        choice = {"index": 0, "delta": {"content": text}, "finish_reason": finish}
        self.raw(f"data: {json.dumps({'choices': [choice]})}\n\n")

    def answer(self, pieces: Sequence[str]) -> None:
        self.stream()
        for one in pieces:
            self.piece(one)
        self.piece(None, "stop")
        self.raw("data: [DONE]\n\n")

    def hang(self) -> None:
        """Until the test is over, or nobody listens any more."""
        self.over.wait(HUNG_S)


def good(*pieces: str) -> Chat:
    return lambda reply: reply.answer(pieces)


GOOD = good("go ", "kit", "chen!")


def failing(code: int, body: str = "") -> Chat:
    return lambda reply: reply.status(code, body)


def never(reply: Reply) -> None:
    reply.hang()


class Server:
    """Answers each chat as the next of `chats` says, the last one for ever."""

    def __init__(self, chats: Sequence[Chat], owner: str, host: str) -> None:
        self.models: object = {"data": [{"id": "tiny", "owned_by": owner}]}
        self.chats = list(chats)
        self.asked: list[dict[str, object]] = []
        self.keys: list[str | None] = []
        self.routes: list[str] = []
        self._models: list[EndpointModel] = []
        self.gone = threading.Event()
        """Set when a client went away while it was answered."""
        self.over = threading.Event()
        self._http = ThreadingHTTPServer((host, 0), self._handler())
        self._http.daemon_threads = False
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.01,))
        self._thread.start()

    @property
    def port(self) -> int:
        return self._http.server_port

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def model(
        self, timeout_s: float = HUNG_S, dialect: GrammarDialect = "auto", **address: Any
    ) -> EndpointModel:
        """A model that asks this server, again at once if that failed; it is closed with it."""
        where = Address(self.url, timeout_s=timeout_s, **address)
        model = EndpointModel(where, dialect=dialect, pauses_s=AT_ONCE_S)
        self._models.append(model)
        return model

    def close(self) -> None:
        for model in self._models:
            model.close()
        assert "edgevox-endpoint" not in {one.name for one in threading.enumerate()}
        self.over.set()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, *_: object) -> None:
                """Tests have their own."""

            def do_GET(self) -> None:
                server.routes.append(self.path)
                body = server.models
                Reply(self, server.over).status(
                    200, body if isinstance(body, str) else json.dumps(body)
                )

            def do_POST(self) -> None:
                length = int(self.headers["Content-Length"])
                server.asked.append(json.loads(self.rfile.read(length)))
                server.routes.append(self.path)
                server.keys.append(self.headers["Authorization"])
                chat = server.chats.pop(0) if len(server.chats) > 1 else server.chats[0]
                try:
                    chat(Reply(self, server.over))
                except OSError:
                    server.gone.set()

        return Handler


@contextmanager
def serving(*chats: Chat, owner: str = "llamacpp", host: str = "127.0.0.1") -> Iterator[Server]:
    server = Server(chats, owner, host)
    try:
        yield server
    finally:
        server.close()


def ask(model: EndpointModel, grammar: str | None = ROOMS, token: CancelToken | None = None) -> str:
    """The whole answer to `CHAT`."""
    token = token or CancelToken()
    return "".join(model.generate(CHAT, grammar=grammar, max_tokens=9, token=token))
