"""Logs and ROS 2: its lines in our stream, ours on ``/rosout``, levels set by its services.

Lines of ROS 2's own C and Python code go through Python's logging, as any library's do. All of them
pass one function pointer of rcutils. `RcutilsStream` passes each line on to logging, and then to
the former function, which writes to ``/rosout`` and to ROS 2's log file. `LoggerLevels` serves
levels for ROS 2's loggers and for ours alike.
"""

import atexit
import ctypes
import logging
import platform
from collections import deque
from collections.abc import Iterable, Sequence
from copy import copy
from itertools import pairwise
from typing import Any, NamedTuple

import rclpy.logging
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Log, LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.files.text import one_line
from edgevox.core.log import ROOT, LogLine
from edgevox.ops.logs import LEVELS, RateLimit, level_of, set_level
from edgevox.ros2.ticker import Ticker

_SEVERITY = {0, 10, 20, 30, 40, 50}
_MOST_BYTES = 8192

_VA_LIST_BYTES = {"x86_64": 24, "aarch64": 32}
"""The size of a va_list, on machines that pass it to functions by its address."""

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
    """Takes over ROS 2's log lines from `open` to `close`, on machines that allow it.

    It waits for Python's lock on the thread that logs. ROS 2 logs there without holding locks of
    its own, except for debug lines of its middleware; therefore levels are left as they are.
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
        """Restore the former output, before ROS 2's context is shut down."""
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
        """Return the message; its arguments are copied, since a reader uses them up."""
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


TOPIC = "/rosout"
LIFESPAN_S = 10.0
MOST_WAITING = 1000
QOS = QoSProfile(
    depth=MOST_WAITING,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    lifespan=Duration(seconds=LIFESPAN_S),
)
"""The same as ROS 2's own."""
PERIOD_S = 0.1


class _KeptRecord(NamedTuple):
    """A record that has waited since `since_s`; one of EdgeVox's own is not formatted yet.

    A record that could keep objects alive, such as a traceback its frames, is formatted at once.
    """

    since_s: float
    record: logging.LogRecord


class Rosout(logging.Handler):
    """Publishes every line that EdgeVox's loggers show, without lines that ROS 2 has published.

    Logging only puts the line into a queue, which the ticker's thread empties: logging never waits
    for the middleware, and causes no line of its own. Without a listener, lines wait there as long
    as the topic would keep them, and no message is made. Beyond the limit, the oldest lines are
    dropped. No line holds what people say.
    """

    def __init__(self, node: Node, ticker: Ticker, clock: Clock | None = None) -> None:
        super().__init__()
        self._clock = clock or SystemClock()
        self._node, self._name = node, node.get_logger().name
        self._publisher = node.create_publisher(Log, TOPIC, QOS)
        self._waiting: deque[_KeptRecord] = deque(maxlen=MOST_WAITING)
        self.addFilter(RateLimit())
        self._stop = ticker.every(PERIOD_S, self._publish)
        logging.getLogger(ROOT).addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Queue it."""
        if not hasattr(record, OF_RCUTILS):
            self._waiting.append(_kept(record, self._clock.now()))

    @property
    def listeners(self) -> int:
        """The number of subscriptions that the publisher knows of."""
        return self._publisher.get_subscription_count()

    def close(self) -> None:
        """Publish what waits, and no more."""
        logging.getLogger(ROOT).removeHandler(self)
        self._stop()
        self._publish()
        self._waiting.clear()  # logging closes every handler again when the program ends
        self._node.destroy_publisher(self._publisher)
        super().close()

    def _publish(self) -> None:
        oldest_s = self._clock.now() - LIFESPAN_S
        while self._waiting and self._waiting[0].since_s < oldest_s:
            self._waiting.popleft()
        if self._waiting and self.listeners:
            while self._waiting:
                self._publisher.publish(_message(self._waiting.popleft().record, self._name))


def _kept(record: logging.LogRecord, now_s: float) -> _KeptRecord:
    if isinstance(record.msg, LogLine) and not record.exc_info:
        return _KeptRecord(now_s, record)
    text = record.getMessage()
    if record.exc_info and record.exc_info[1]:
        text += f": {type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
    bare = copy(record)
    bare.msg, bare.args, bare.exc_info = text, (), None
    return _KeptRecord(now_s, bare)


def _message(record: logging.LogRecord, node: str) -> Log:
    """Under the node's name, as ROS 2 knows it, and that of our module."""
    second, part = divmod(record.created, 1.0)
    return Log(
        stamp=Time(sec=int(second), nanosec=int(part * 1e9)),
        level=record.levelno,
        name=node + record.name.removeprefix(ROOT),
        msg=one_line(record.getMessage()),
        file=record.pathname,
        function=record.funcName or "",
        line=record.lineno,
    )


_OPTION = "--log-level"


class LoggerLevels:
    """Serves ``~/get_logger_levels`` and ``~/set_logger_levels``, instead of rclpy.

    A name stands for both Python's logger and ROS 2's. The node's own logger, as ``/rosout`` shows
    it, stands for all of EdgeVox.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._services = (
            node.create_service(GetLoggerLevels, "~/get_logger_levels", self._get),
            node.create_service(SetLoggerLevels, "~/set_logger_levels", self._set),
        )

    def close(self) -> None:
        """Serve them no more."""
        for service in self._services:
            self._node.destroy_service(service)

    def _get(
        self, request: GetLoggerLevels.Request, response: GetLoggerLevels.Response
    ) -> GetLoggerLevels.Response:
        response.levels = [LoggerLevel(name=n, level=self._level(n)) for n in request.names]
        return response

    def _set(
        self, request: SetLoggerLevels.Request, response: SetLoggerLevels.Response
    ) -> SetLoggerLevels.Response:
        response.results = [self._change(one.name, one.level) for one in request.levels]
        return response

    def _level(self, name: str) -> int:
        level = level_of(self._ours(name))
        if level:
            return level
        try:
            return int(rclpy.logging.get_logger_level(name))
        except RuntimeError:
            return LEVELS["unset"]

    def _change(self, name: str, level: int) -> SetLoggerLevelsResult:
        if level not in LEVELS.values():
            known = ", ".join(str(number) for number in sorted(set(LEVELS.values())))
            return SetLoggerLevelsResult(reason=f"level: got {level}, expected one of {known}")
        try:
            rclpy.logging.set_logger_level(name, level, detailed_error=True)
        except RuntimeError as error:
            return SetLoggerLevelsResult(reason=str(error))
        _set_ours(self._ours(name), level)
        return SetLoggerLevelsResult(successful=True)

    def _ours(self, name: str) -> str:
        """The name of Python's logger."""
        node = self._node.get_logger().name
        of_node = name == node or name.startswith(f"{node}.")
        return ROOT + name[len(node) :] if of_node else name


def apply_log_levels(ros_args: Sequence[str]) -> None:
    """Apply ROS 2's ``--log-level`` also to EdgeVox's loggers. Raises nothing: rcl checks."""
    for name, level in _asked(ros_args):
        if level in LEVELS:
            _set_ours(name, LEVELS[level])


def _set_ours(name: str, level: int) -> None:
    """Above all loggers is none to follow: there, unset is what it is for ROS 2."""
    set_level(name, level if name or level else LEVELS["info"])


def _asked(ros_args: Sequence[str]) -> Iterable[tuple[str, str]]:
    for option, value in pairwise(ros_args):
        if option == _OPTION:
            name, assigned, level = value.rpartition(":=")
            yield (name if assigned else "", level.lower())
