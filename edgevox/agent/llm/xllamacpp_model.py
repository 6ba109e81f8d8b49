"""A language model run by xllamacpp: llama.cpp's server inside this process, no compiler needed.

JSON over HTTP over a Unix socket: the little that an engine cannot be asked in process.

The folder of a model's socket; what a killed process left, the next start removes.
"""

import fcntl
import http.client
import importlib
import json
import math
import os
import secrets
import shutil
import socket
import tempfile
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from edgevox.agent.llm import weights
from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage, ModelFailed, Piece
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import install_extra
from edgevox.core.log import get_logger

log = get_logger(__name__)


_TIMEOUT_S = 10.0


class _Connection(http.client.HTTPConnection):
    def __init__(self, path: Path) -> None:
        super().__init__("localhost", timeout=_TIMEOUT_S)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(_TIMEOUT_S)
        self.sock.connect(str(self._path))


def post(path: Path, route: str, body: dict[str, Any], key: str) -> dict[str, Any]:
    """The reply's JSON object. Raises `ModelFailed` for a refusal, and without a reply."""
    connection = _Connection(path)
    headers = {"Content-Type": "application/json", "Authorization": f"Bearer {key}"}
    try:
        connection.request("POST", route, json.dumps(body), headers)
        response = connection.getresponse()
        reply = response.read()
    except OSError as error:
        raise ModelFailed(f"the model's socket does not answer: {error}") from None
    finally:
        connection.close()
    if response.status != http.client.OK:
        raise ModelFailed(f"{route}: the model answered {response.status}: {reply[:200]!r}")
    found: dict[str, Any] = json.loads(reply)
    return found


PREFIX = "edgevox-llm-"


class SocketFolder:
    """A new folder for a model's socket, which only this user may enter.

    The folder is locked for the life of this process, however it ends. A process number would not
    do, because it means another process in the next container.
    """

    def __init__(self, parent: Path | None = None) -> None:
        parent = parent or Path(tempfile.gettempdir())
        remove_abandoned(parent)
        # Its first name keeps `remove_abandoned` away until it is locked.
        made = Path(tempfile.mkdtemp(prefix=f".{PREFIX}", dir=parent))
        self._lock = os.open(made, os.O_RDONLY | os.O_DIRECTORY)
        with suppress(OSError):  # a file system without locks: there nobody else gets one, either
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self.path = made.rename(parent / made.name.removeprefix("."))

    def close(self) -> None:
        """Remove it; a second time does nothing."""
        if self._lock >= 0:
            shutil.rmtree(self.path, ignore_errors=True)
            os.close(self._lock)
            self._lock = -1


def remove_abandoned(parent: Path) -> None:
    """Remove this user's folders of this kind whose process is gone."""
    for folder in parent.glob(f"{PREFIX}*"):
        with suppress(OSError):  # somebody else's, or gone meanwhile, or still in use
            lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                if os.fstat(lock).st_uid == os.geteuid():
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(folder)
            finally:
                os.close(lock)


KEPT_PROMPTS_MIB = 64
"""Room for the prompts of other agents and languages, so that a hand-off and back reads none of
them again."""


class XllamacppModel:
    """Implements `LanguageModel`.

    The engine insists on serving HTTP too. It is given a Unix socket in a folder that only this
    user may enter, and a random key; nothing listens on the network. The socket counts tokens,
    which the engine offers no other way.
    """

    def __init__(
        self, path: Path, *, context_tokens: int = CONTEXT_TOKENS, threads: int | None = None
    ) -> None:
        weights.spin_briefly()
        self.name = path.stem
        self.context_tokens = context_tokens
        self._closed = threading.Event()
        self._key = secrets.token_urlsafe(32)
        self._folder = SocketFolder()
        self._socket = self._folder.path / "llm.sock"  # the suffix makes it one
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="xllamacpp")
        try:
            self._server: Any = _serve(path, context_tokens, threads, self._socket, self._key)
        except ModelFailed:
            self.close()
            raise
        except RuntimeError as error:
            self.close()
            raise ModelFailed(f"{path}: xllamacpp could not load it: {error}") from None
        # An engine that is destroyed before its loop runs never ends; one that answered has it.
        self._server.handle_completions({"prompt": " ", "max_tokens": 1})

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        request = _request(messages, grammar, max_tokens)
        answer = _ServerAnswer(token, self._closed)
        try:
            work = self._worker.submit(self._run, request, answer)
        except RuntimeError:
            raise ModelFailed(f"{self.name} is closed") from None
        work.add_done_callback(answer.end)
        try:
            yield from answer.pieces()
        finally:
            answer.abandon()
        if self._closed.is_set() and not token.cancelled:
            raise ModelFailed(f"{self.name} was closed while it answered")

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """See `LanguageModel.prime`."""
        for _ in self.generate(messages, grammar=None, max_tokens=1, token=token):
            pass

    def count_tokens(self, text: str) -> int:
        """Number of tokens of this text."""
        if self._closed.is_set():
            raise ModelFailed(f"{self.name} is closed")
        reply = post(self._socket, "/tokenize", {"content": text}, self._key)
        return len(reply["tokens"])

    def close(self) -> None:
        """See `LanguageModel.close`; waits for the batch or the token that is being computed."""
        self._closed.set()
        self._worker.shutdown(wait=True)
        self._server = None
        self._folder.close()

    def _run(self, request: dict[str, Any], answer: "_ServerAnswer") -> None:
        if not answer.unwanted:
            self._server.handle_chat_completions(request, answer.hear)


class _ServerAnswer:
    """An answer on its way from the engine's thread to the thread that iterates over it.

    The request's `max_tokens` bounds the pieces that wait in between.
    """

    def __init__(self, token: CancelToken, closed: threading.Event) -> None:
        self._token = token
        self._closed = closed
        self._abandoned = threading.Event()
        self._queue: SimpleQueue[str | Exception | None] = SimpleQueue()

    @property
    def unwanted(self) -> bool:
        return self._token.cancelled or self._closed.is_set() or self._abandoned.is_set()

    def hear(self, chunk: dict[str, Any]) -> bool:
        """Take one chunk from the engine; True tells it to stop."""
        if "error" in chunk:
            self._queue.put(ModelFailed(f"the model refused: {chunk['error']['message']}"))
        for choice in chunk.get("choices", ()):
            text = choice["delta"].get("content")
            if text:
                tokens = (choice.get("logprobs") or {}).get("content") or ()
                likely = math.exp(min((one["logprob"] for one in tokens), default=0.0))
                self._queue.put(Piece(text, likely))
        return self.unwanted

    def end(self, work: "Future[None]") -> None:
        """The engine is done with it, one way or the other."""
        error = None if work.cancelled() else work.exception()
        if error is not None:
            log.error("model_engine_failed", engine="xllamacpp", exc_info=error)
            self._queue.put(ModelFailed(f"the engine failed: {error}"))
        self._queue.put(None)

    def pieces(self) -> Iterator[str]:
        """Yield pieces, blocking for each; end with the engine, or once abandoned."""
        forget = self._token.on_cancel(lambda: self._queue.put(None))
        try:
            while (item := self._queue.get()) is not None:
                if self._token.cancelled:
                    return
                if isinstance(item, Exception):
                    raise item
                yield item
        finally:
            forget()

    def abandon(self) -> None:
        """Tell that no thread reads the answer any more."""
        self._abandoned.set()


def _serve(path: Path, context_tokens: int, threads: int | None, socket: Path, key: str) -> Any:
    try:
        xllamacpp = importlib.import_module("xllamacpp")
    except ImportError as error:
        raise ModelFailed(
            f"xllamacpp cannot be imported ({error}): {install_extra('llm')}"
        ) from None
    count = threads or weights.default_threads()
    wanted = xllamacpp.CommonParams()
    wanted.model.path = str(path)
    wanted.n_ctx = context_tokens
    wanted.n_parallel = 1
    wanted.n_batch = wanted.n_ubatch = weights.BATCH_TOKENS
    wanted.cpuparams.n_threads = wanted.cpuparams_batch.n_threads = count
    wanted.cache_ram_mib = KEPT_PROMPTS_MIB
    wanted.n_ctx_checkpoints = 0
    wanted.fit_params = False
    wanted.verbosity = -1
    wanted.hostnames = [str(socket)]
    wanted.api_keys = [key]
    wanted.n_threads_http = 1
    wanted.ui = wanted.endpoint_slots = wanted.endpoint_props = False
    return xllamacpp.Server(wanted)


def _request(
    messages: Sequence[ChatMessage], grammar: str | None, max_tokens: int
) -> dict[str, Any]:
    request: dict[str, Any] = {
        "messages": [{"role": m.role, "content": m.content} for m in messages],
        "max_tokens": max_tokens,
        "stream": True,
        # With progress the engine reports each batch of the prompt, so that it can be told to stop.
        "return_progress": True,
        "temperature": 0.0,
        "top_k": 1,
        "cache_prompt": True,
        "logprobs": True,
        "top_logprobs": 1,
    }
    if grammar is not None:
        request["grammar"] = grammar
    return request
