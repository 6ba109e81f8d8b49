"""JSON over HTTP over a Unix socket: the little that an engine cannot be asked in process."""

import http.client
import json
import socket
from pathlib import Path
from typing import Any

from edgevox.agent.llm.language_model import ModelFailed

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
    """The reply's JSON object. Raises `ModelFailed` when it is refused or nobody answers."""
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
