"""No microphone at all."""

import threading

from edgevox.voice.audio import Frame


class Nothing:
    """Never hears anything; reading only waits."""

    name = "none"

    def __init__(self) -> None:
        self._closed = threading.Event()

    def start(self) -> None: ...

    def read(self, timeout_s: float) -> Frame | None:
        self._closed.wait(timeout_s)
        return None

    def close(self) -> None:
        self._closed.set()
