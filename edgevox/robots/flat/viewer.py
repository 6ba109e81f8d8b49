"""Shows a body's picture in a window, where there is a display.

Toolkits want the main thread, which the terminal has, so the window is a process of its own
(`viewer_window.py`) that is fed with pictures through a pipe. Whatever happens to it, the robot
does not notice; it ends with the process that started it.
"""

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from typing import IO, cast

import numpy as np
from numpy.typing import NDArray

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger

log = get_logger(__name__)

PERIOD_S = 0.1
"""Time between two pictures."""
_SHARE = 0.25
"""The part of its time that the viewer may draw: slow pictures come less often."""
_LAST_WORDS_S = 2.0

Pixels = NDArray[np.uint8]


def has_display(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether there is a screen for a window."""
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


class Viewer:
    """A window that shows `picture` repeatedly, ten times a second at most.

    `picture` returns (height, width, 3), RGB, and is called on the viewer's own thread only. A
    picture that cannot be shown, or a closed window, ends the viewer with one line in the log.
    """

    def __init__(
        self, picture: Callable[[], Pixels], title: str, *, clock: Clock | None = None
    ) -> None:
        self._picture = picture
        self._title = title
        self._clock = clock or SystemClock()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._window: subprocess.Popen[bytes] | None = None

    @property
    def running(self) -> bool:
        """Whether the window gets pictures."""
        return self._thread is not None and self._thread.is_alive()

    def start(self) -> None:
        """Open the window."""
        command = [sys.executable, "-m", "edgevox.robots.flat.viewer_window", self._title]
        self._window = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the terminal's program, not for the window
        )
        self._thread = threading.Thread(target=self._run, args=(self._window,), name="viewer")
        self._thread.start()

    def close(self) -> None:
        """Close the window and wait for the thread and the process to end."""
        self._closing.set()
        if self._window is not None:
            self._window.kill()
        if self._thread is not None:
            self._thread.join()

    def _run(self, window: subprocess.Popen[bytes]) -> None:
        with window:
            try:
                self._feed(cast("IO[bytes]", window.stdin))
            except OSError:
                self._explain(window)
            except Exception:
                log.exception("window_without_picture")
            finally:
                window.kill()
                with contextlib.suppress(OSError):
                    cast("IO[bytes]", window.stdin).close()

    def _feed(self, pipe: IO[bytes]) -> None:
        while not self._closing.is_set():
            began_s = self._clock.now()
            pixels = self._picture()
            drawn_s = self._clock.now() - began_s
            pipe.write(as_ppm(pixels))
            pipe.flush()
            self._closing.wait(max(PERIOD_S - drawn_s, drawn_s / _SHARE - drawn_s))

    def _explain(self, window: subprocess.Popen[bytes]) -> None:
        """Say why the window does not take pictures any more."""
        if self._closing.is_set():
            return
        try:
            _, told = window.communicate(timeout=_LAST_WORDS_S)
        except (subprocess.TimeoutExpired, OSError, ValueError):
            told = b""
        words = told.decode("utf-8", errors="replace").strip().splitlines()
        if window.returncode:
            reason = words[-1] if words else f"it ended with {window.returncode}"
            log.warning("no_window", reason=reason)
        else:
            log.info("window_closed")


def as_ppm(pixels: Pixels) -> bytes:
    """A picture of shape (height, width, 3) as a PPM file, which every toolkit reads."""
    height, width, _ = pixels.shape
    return b"P6 %d %d 255\n" % (width, height) + np.ascontiguousarray(pixels, np.uint8).tobytes()
