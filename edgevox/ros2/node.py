"""The node: its rclpy context, its name, and the thread that spins it.

`choose_profile` sets up Fast DDS, the usual middleware of ROS 2, before a node is made. By default
it hands messages of the same machine over in shared memory, and throws away messages for a process
that has not looked for a second: frozen, or starved of the processor. The sender tries again with
its next heartbeat, up to 3 s later; for so long a "stop" was lost. So EdgeVox's nodes ask to be
written to by UDP: the kernel keeps messages until they look. They still write to others in shared
memory.

A heartbeat, kept by the working thread, tells a watching thread how long ago the last beat was.

`QuietNode` looks for incompatible peers once in a while, not with every message. rclpy gives each
publisher and each subscription an event handler, which warns of a peer whose QoS or type does not
fit, and its executor prepares and checks all of them whenever it wakes: with some fifty topics that
was half of the work of an answer. Here they are looked at together, when `look` is called; they
warn as ever, a moment later.

`spin_until` runs an executor's callbacks, and `end_spin` ends that before the executor is shut
down: `Executor.shutdown` frees what a callback on another thread may be about to use, seen in rclpy
7.1, once in some hundred ends of a busy node, as `InvalidHandle`. No wait is for ever: seen with
Fast DDS 2.14 and glibc 2.36, a thread slept on in `rcl_wait` after a message and a signal had come.
A lost wake-up costs a second at most.
"""

import math
import os
import sys
import threading
from collections import deque
from collections.abc import Callable, MutableMapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from rclpy.waitable import Waitable

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.ops.logs import is_set_up
from edgevox.ros2.contract import NODE_NAME
from edgevox.ros2.logs import LoggerLevels, RcutilsStream, apply_log_levels

log = get_logger(__name__)

LONGEST_WAIT_S = 1.0


def spin_until(ended: threading.Event, executor: Executor) -> None:
    """Run callbacks until it is set. Raises what they raise, or `ExternalShutdownException`."""
    while not ended.is_set():
        executor.spin_once(timeout_sec=LONGEST_WAIT_S)


def end_spin(ended: threading.Event, executor: Executor, thread: threading.Thread) -> None:
    """End the thread that spins, and then the executor. Not to be called on that thread."""
    ended.set()
    executor.create_task(_nothing)  # `wake` alone leaves `spin_once` waiting for a callback
    if thread.is_alive():
        thread.join()
    executor.shutdown()


def _nothing() -> None:
    """A callback for a thread that has nothing else to do."""


PROFILE = Path(__file__).with_name("fast_dds.xml")
READ_BY_FAST_DDS = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that the Fast DDS of ROS 2 Jazzy reads."""
GIVEN = "FASTDDS_DEFAULT_PROFILES_FILE"
"""The variable's name from Fast DDS 3 on, and in the reference: EdgeVox also reads it."""
TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"
_WITH_UDP = ("", "DEFAULT", "UDPv4")


def choose_profile(environment: MutableMapping[str, str] = os.environ) -> None:
    """Use EdgeVox's profile for the next nodes of this process, or the user's own.

    A user who chose transports without plain UDP gets those, and no profile of EdgeVox. Call it
    before the first node is made; other middlewares ignore it.
    """
    if environment.get(READ_BY_FAST_DDS):
        return
    if given := environment.get(GIVEN):
        environment[READ_BY_FAST_DDS] = given
    elif environment.get(TRANSPORTS, "") in _WITH_UDP:
        environment[READ_BY_FAST_DDS] = str(PROFILE)


LATELY_S = 60.0
_MOST_BEATS = 256


class Heartbeat:
    """Counts from its making on. `beat` may be called from any thread.

    A beat that comes later than `period_s` after the one before is late.
    """

    def __init__(self, clock: Clock | None = None, period_s: float = 0.0) -> None:
        self._clock = clock or SystemClock()
        self._period_s = period_s
        self._late: deque[tuple[float, float]] = deque(maxlen=_MOST_BEATS)
        self._beat_s = self._clock.now()

    def begin(self) -> None:
        """Count from now on."""
        self._late.clear()
        self._beat_s = self._clock.now()

    def beat(self) -> None:
        """Here I am."""
        now_s = self._clock.now()
        self._late.append((now_s, now_s - self._beat_s - self._period_s))
        self._beat_s = now_s

    @property
    def silent_s(self) -> float:
        """Seconds since the last beat."""
        return max(0.0, self._clock.now() - self._beat_s)

    @property
    def lag_s(self) -> float:
        """The most by which a beat was late in the last minute, or is already."""
        now_s = self._clock.now()
        lately = [late_s for when_s, late_s in tuple(self._late) if now_s - when_s < LATELY_S]
        return max(0.0, now_s - self._beat_s - self._period_s, *lately)


class QuietNode(Node):
    """A node whose executor waits for messages, services and timers only."""

    def __init__(self, *args: Any, **options: Any) -> None:
        self._events: list[EventHandler] = []
        super().__init__(*args, **options)

    def look(self) -> None:
        """Call the handlers whose event has come; on the executor's thread, in a timer."""
        context = self.context.handle
        if context is None:
            return
        with ExitStack() as held, context:
            alive = [one for one in list(self._events) if _enters(held, one)]
            wait_set = rcl.WaitSet(0, 0, 0, 0, 0, len(alive), context)
            wait_set.clear_entities()
            for one in alive:
                one.add_to_wait_set(wait_set)
            wait_set.wait(0)
            come = [(one, one.take_data()) for one in alive if one.is_ready(wait_set)]
        for one, what in come:
            one.callback(what)

    def add_waitable(self, waitable: Waitable) -> None:
        """Collect the event handlers that rclpy adds for every publisher and subscription."""
        if isinstance(waitable, EventHandler):
            self._events.append(waitable)
        else:
            super().add_waitable(waitable)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        self._give_back(publisher.event_handlers)
        return bool(super().destroy_publisher(publisher))

    def destroy_subscription(self, subscription: Subscription) -> bool:
        self._give_back(subscription.event_handlers)
        return bool(super().destroy_subscription(subscription))

    def _give_back(self, handlers: Any) -> None:
        """Put them where rclpy believes them to be, and removes them from."""
        for one in handlers:
            if one in self._events:
                self._events.remove(one)
                super().add_waitable(one)


def _enters(held: ExitStack, handler: EventHandler) -> bool:
    """Keep it from being destroyed meanwhile; False if it is already."""
    try:
        held.enter_context(handler)
    except InvalidHandle:
        return False
    return True


BEAT_S = 1.0
"""Seconds between two signs of life of the executor; each costs it about 1 ms."""


class RosBridgeFailed(EdgeVoxError):
    """ROS 2 is here but cannot be used; the message is its own reason."""


class RosNode:
    """Owns an rclpy node. One thread runs all of its callbacks, so none of them may block.

    Raises `RosBridgeFailed` if the context or the node cannot be made.
    """

    def __init__(
        self,
        namespace: str,
        ros_args: Sequence[str] = (),
        *,
        name: str = NODE_NAME,
        own_name: bool = False,
    ) -> None:
        """With `own_name` the node keeps its name and namespace.

        `__node` and `__ns` of the arguments are then another node's of this process: the agent's.
        """
        choose_profile()
        self._context = Context()
        self._lines = RcutilsStream() if is_set_up() else None
        quiet = ["--ros-args", "--disable-stdout-logs"] if self._lines else []
        self._ros_args = [*(ros_args or sys.argv), *quiet]
        try:
            self._init()
            kept = ["--ros-args", "-r", f"__node:={name}", "-r", f"__ns:={namespace}"]
            self.node = QuietNode(
                name,
                namespace=namespace,
                context=self._context,
                cli_args=kept if own_name else None,
            )
            LoggerLevels(self.node)
            self.executor = SingleThreadedExecutor(context=self._context)
        except Exception as error:
            self._shut_down()
            raise RosBridgeFailed(f"ROS 2 could not be started: {error}") from error
        self.executor.add_node(self.node)
        self._heartbeat = Heartbeat(period_s=BEAT_S)
        # Of its own clock, which goes on when that of the robot stands still.
        steady = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(BEAT_S, self._beat, clock=steady)
        self.failed = 0
        """Callbacks that raised."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="edgevox-ros2")

    def start(self) -> None:
        self._heartbeat.begin()
        self._thread.start()

    def close(self) -> None:
        """Leave the graph: the thread joined, shared memory freed."""
        end_spin(self._closing, self.executor, self._thread)
        self.node.destroy_node()
        self._shut_down()

    @property
    def name(self) -> str:
        """The node's full name."""
        return str(self.node.get_fully_qualified_name())

    @property
    def stalled_s(self) -> float:
        """Seconds for which a callback has held up all others; infinite if the thread died.

        0 before `start` and after `close`.
        """
        if self._thread.ident is None or self._closing.is_set():
            return 0.0
        late_s = max(0.0, self._heartbeat.silent_s - BEAT_S)
        return late_s if self._thread.is_alive() else math.inf

    @property
    def lag_s(self) -> float:
        """The longest that callbacks had to wait in the last minute; 0 unless it spins."""
        begun = self._thread.ident is not None and not self._closing.is_set()
        return self._heartbeat.lag_s if begun else 0.0

    def beside(self, name: str) -> tuple[Node, Callable[[], None]]:
        """Make a node that only publishes, in a context of its own; returns it and what ends it.

        Its names are not remapped. A name that begins with an underscore is hidden.
        """
        context = Context()
        context.init(self._ros_args)
        node = Node(
            name,
            namespace=self.node.get_namespace(),
            context=context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )

        def leave() -> None:
            node.destroy_node()
            context.try_shutdown()

        return node, leave

    def _beat(self) -> None:
        self._heartbeat.beat()
        self.node.look()

    def _init(self) -> None:
        """Start the context; ROS 2 writes no lines of its own if EdgeVox's go to one stream."""
        self._context.init(self._ros_args)
        apply_log_levels(self._ros_args)
        if self._lines:
            self._lines.open()

    def _shut_down(self) -> None:
        if self._lines:
            self._lines.close()
        self._context.try_shutdown()

    def _spin(self) -> None:
        """Run callbacks until the end; one that fails is logged and must not end the others."""
        while not self._closing.is_set():
            try:
                spin_until(self._closing, self.executor)
            except ExternalShutdownException:
                return
            except Exception:
                self.failed += 1
                log.exception("ros_callback_failed")
