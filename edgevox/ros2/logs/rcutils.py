"""What ROS 2's own C and Python code logs goes through Python's logging, as any library's does.

All of it goes through one function pointer of rcutils. Ours passes each line on to logging, and
then to the one that was there before, which writes to ``/rosout`` and to ROS 2's log file.
"""

import atexit
import ctypes
import logging
import platform
from typing import Any

_SEVERITY = {0, 10, 20, 30, 40, 50}
_MOST_BYTES = 8192

_VA_LIST_BYTES = {"x86_64": 24, "aarch64": 32}
"""How large a va_list is where one is handed to functions by its address."""

OF_RCUTILS = "_of_rcutils"
"""Marks a record that is on ``/rosout`` already."""


class _CodeLocation(ctypes.Structure):
    _fields_ = (
        ("function", ctypes.c_char_p),
        ("file", ctypes.c_char_p),
        ("line", ctypes.c_size_t),
    )


_Handler = ctypes.CFUNCTYPE(
    None,
    ctypes.POINTER(_CodeLocation),
    ctypes.c_int,
    ctypes.c_char_p,
    ctypes.c_int64,
    ctypes.c_char_p,
    ctypes.c_void_p,
)
_ours: set[int] = set()
"""The addresses of handlers of this module: lines must not be passed on twice."""


class RcutilsStream:
    """Takes over ROS 2's lines from `open` to `close`; does nothing where it cannot.

    It waits for Python's lock on whatever thread logs. ROS 2 logs there without holding locks of
    its own, but for debug lines of its middleware: so levels are left as they are.
    """

    def __init__(self) -> None:
        self._size = _VA_LIST_BYTES.get(platform.machine(), 0)
        self._before: Any = None
        self._address = 0
        self._callback = _Handler(self._handle)

    def open(self) -> None:
        """Call this when ROS 2 has set up its logging, or another one is open already."""
        if not self._size:
            return
        rcutils, before = _rcutils(), _current()
        if before in _ours or not before:
            return
        self._before = _Handler(before)
        self._address = ctypes.cast(self._callback, ctypes.c_void_p).value or 0
        _ours.add(self._address)
        rcutils.rcutils_logging_set_output_handler(self._callback)
        atexit.register(self.close)  # no thread of the middleware may call into a dead interpreter

    def close(self) -> None:
        """As it was before; call this before ROS 2's context is shut down."""
        if not self._address:
            return
        if _current() == self._address:
            _rcutils().rcutils_logging_set_output_handler(self._before)
        _ours.discard(self._address)
        self._address = 0
        atexit.unregister(self.close)

    def _handle(  # noqa: PLR0917 - C's signature
        self,
        location: Any,
        severity: int,
        name: bytes | None,
        stamp_ns: int,
        text: bytes | None,
        arguments: int | None,
    ) -> None:
        level = severity if severity in _SEVERITY else logging.INFO
        logger = logging.getLogger((name or b"").decode("utf-8", "replace") or "ros2")
        if logger.isEnabledFor(level):
            logger.handle(_record(logger, level, location, self._formatted(text, arguments)))
        self._before(location, severity, name, stamp_ns, text, arguments)

    def _formatted(self, text: bytes | None, arguments: int | None) -> str:
        """The message; its arguments are copied, since whoever reads them uses them up."""
        if not arguments or not text:
            return (text or b"").decode("utf-8", "replace")
        copy = ctypes.create_string_buffer(ctypes.string_at(arguments, self._size), self._size)
        written = ctypes.create_string_buffer(_MOST_BYTES)
        _libc.vsnprintf(written, ctypes.c_size_t(_MOST_BYTES), text, copy)
        return written.value.decode("utf-8", "replace")


def _record(logger: logging.Logger, level: int, location: Any, text: str) -> logging.LogRecord:
    file, line, function = "", 0, ""
    if location:
        at = location.contents
        file, function = (at.file or b"").decode(), (at.function or b"").decode()
        line = at.line
    more = {OF_RCUTILS: True}
    return logger.makeRecord(logger.name, level, file, line, text, (), None, function, more)


_libc = ctypes.CDLL(None)


def _rcutils() -> ctypes.CDLL:
    """The library that rclpy has loaded already."""
    library = ctypes.CDLL("librcutils.so")
    library.rcutils_logging_get_output_handler.restype = ctypes.c_void_p
    library.rcutils_logging_set_output_handler.restype = None
    return library


def _current() -> int | None:
    address: int | None = _rcutils().rcutils_logging_get_output_handler()
    return address
