"""Clients of ROS 2 interfaces for skills: services, topics, actions, and waits that have an end.

A skill's thread waits, the node's thread never does. `on_node_thread` runs work on the thread that
spins the node, for a caller on another thread. Meanwhile nothing else happens to the node: rclpy's
action clients and a node's lists of its entities are not made for several threads.

Failures are told in the robot's languages (`interface_reason`).
"""

import contextlib
import threading
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, wait
from typing import Any, TypeVar

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.task import Future as RosFuture

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import in_words
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.languages import CODES, language_file
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.ros2.messages import interface_profile

log = get_logger(__name__)

LOOK_AGAIN_S = 0.05


class TookTooLong(Exception):
    """The awaited event did not come in time."""


def wait_for(future: RosFuture, token: CancelToken, timeout_s: float) -> Any:
    """The result of a future. Raises `Cancelled`, or `TookTooLong`."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    forget = token.on_cancel(done.set)
    try:
        done.wait(timeout_s)
    finally:
        forget()
    if future.done():
        return future.result()
    token.check()
    raise TookTooLong


def wait_until(
    look: Callable[[], bool], token: CancelToken, timeout_s: float, clock: Clock
) -> None:
    """Block until the graph shows something that has no event. Raises as `wait_for` does."""
    until_s = clock.now() + timeout_s
    while not look():
        token.check()
        if clock.now() >= until_s:
            raise TookTooLong
        token.wait(LOOK_AGAIN_S)


class Newest:
    """The newest messages of a topic, taken on the node's thread and awaited on others.

    A waiting caller gets every message, however fast they come. `keeps` is the number of messages
    that are kept for a caller who begins to wait after they came.
    """

    def __init__(self, clock: Clock, keeps: int = 1) -> None:
        self._clock = clock
        self._changed = threading.Condition()
        self._kept: deque[tuple[float, Any]] = deque(maxlen=keeps)
        self._waiting: list[deque[Any]] = []

    def take(self, message: Any) -> None:
        """A message has come."""
        with self._changed:
            self._kept.append((self._clock.now(), message))
            for waits in self._waiting:
                waits.append(message)
            self._changed.notify_all()

    def young(self, oldest_s: float) -> Any:
        """The newest message, unless it is older; None if there is none."""
        with self._changed:
            if not self._kept:
                return None
            at_s, message = self._kept[-1]
            return message if self._clock.now() - at_s <= oldest_s else None

    def since(self, begun_s: float) -> list[Any]:
        """Return the kept messages that came since then, the oldest first."""
        with self._changed:
            return [message for at_s, message in self._kept if at_s >= begun_s]

    def wait(
        self,
        fits: Callable[[Any], bool],
        token: CancelToken,
        timeout_s: float,
        known: Callable[[], Iterable[Any]] = tuple,
    ) -> Any:
        """The first message that fits: of those `known` when it begins, or that come from then on.

        Raises `Cancelled`, or `TookTooLong`.
        """
        until_s = self._clock.now() + timeout_s
        forget = token.on_cancel(self._wake)
        with self._changed:  # nothing comes between what is known and what will come
            waits = deque(known())
            self._waiting.append(waits)
        try:
            while True:
                if self._next(waits, token, until_s) and fits(message := waits.popleft()):
                    return message
        finally:
            forget()
            with self._changed:
                self._waiting = [one for one in self._waiting if one is not waits]

    def _next(self, waits: "deque[Any]", token: CancelToken, until_s: float) -> bool:
        """Return whether there is a message; False for an idle wake-up.

        A flood of messages that do not fit delays neither a stop nor the timeout.
        """
        token.check()
        with self._changed:
            left_s = until_s - self._clock.now()
            if left_s <= 0:
                self._waiting = [one for one in self._waiting if one is not waits]
            if waits:
                return True
            if left_s <= 0:
                raise TookTooLong
            self._changed.wait(left_s)
            return bool(waits)

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify_all()


def interface_reason(code: str, *, what: str) -> Reason:
    """The reason of this code; `what` is the interface, by its name.

    A language whose file lacks it says it in English.
    """
    tables = {one: language_file(one).get("interfaces", {}) for one in CODES}
    sentences = {one: table[code] for one, table in tables.items() if code in table}
    values = {"what": what.strip("~/").replace("_", " ").replace("/", " ")}
    return Reason(in_words(sentences["en"], values), code, values, sentences)


T = TypeVar("T")

NODE_S = 5.0
"""Seconds that the node's thread may be busy with other work."""


class NodeBusy(Exception):
    """The node's thread did not come to it."""


def on_node_thread(node: Node, work: Callable[[Node], T], timeout_s: float = NODE_S) -> T:
    """Run `work` on the thread that spins the node, where it must not wait; return its result.

    Raises the errors of `work`, or `NodeBusy` if it has not begun by then; it is not begun later.
    """
    done: Future[T] = Future()
    try:
        if node.executor is None:
            raise NodeBusy
        node.executor.create_task(_do, work, node, done)
    except InvalidHandle:  # it is shut down
        raise NodeBusy from None
    wait([done], timeout_s)
    if not done.done() and done.cancel():
        raise NodeBusy
    return done.result()


def _do(work: Callable[[Node], T], node: Node, done: "Future[T]") -> None:
    if not done.set_running_or_notify_cancel():
        return
    try:
        done.set_result(work(node))
    except BaseException as error:  # noqa: BLE001 - whoever waits for it gets it
        done.set_exception(error)


THERE_S = 3.0
"""Seconds that the discovery of an interface may take."""


class InterfaceClient:
    """A client of the interface of this type and name, on a node.

    Make it on the thread that spins the node, or before anything spins it; use it on others.
    """

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        self.name = name
        self._node, self._kind, self._clock = node, kind, clock

    def failed(self, code: str) -> SkillFailed:
        """Log the failure, and return the error to raise."""
        log.warning("interface_failed", interface=self.name, why=code)
        return SkillFailed(interface_reason(code, what=self.name))

    def until_there(
        self, look: Callable[[], bool], token: CancelToken, timeout_s: float, code: str
    ) -> None:
        """Wait until it is discovered. Raises `SkillFailed` by this code, or `Cancelled`."""
        try:
            wait_until(look, token, min(THERE_S, timeout_s), self._clock)
        except TookTooLong:
            raise self.failed(code) from None


class ServiceCaller(InterfaceClient):
    """A service's client."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        super().__init__(node, kind, name, clock)
        self._client = node.create_client(kind, name)

    def until_ready(self, token: CancelToken, timeout_s: float) -> None:
        """Wait until it is there. Raises `SkillFailed`, or `Cancelled`."""
        self.until_there(self._client.service_is_ready, token, timeout_s, "not_there")

    def call(
        self,
        request: Any,
        token: CancelToken,
        timeout_s: float,
        give_up: Callable[[], None] = lambda: None,
    ) -> Any:
        """Return the service's answer.

        Raises `SkillFailed` if the service is missing or silent, or `Cancelled`. `give_up` is
        called on a timeout, because the service may still be working.
        """
        self.until_ready(token, timeout_s)
        future = self._client.call_async(request)
        try:
            return wait_for(future, token, timeout_s)
        except (TookTooLong, Cancelled) as end:
            self._client.remove_pending_request(future)
            if isinstance(end, Cancelled):
                raise
            give_up()
            raise self.failed("no_answer") from None


STEERING = frozenset({"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"})
"""Velocities have one way, with limits, a watchdog and the policy: that of drives."""


def type_name(kind: Any) -> str:
    """The name of a message's class, such as ``std_msgs/msg/String``."""
    return "/".join((kind.__module__.split(".")[0], "msg", kind.__name__))


class TopicSender(InterfaceClient):
    """A topic's publisher; a `latched` message is kept for late subscribers."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock, *, latched: bool) -> None:
        super().__init__(node, kind, name, clock)
        self._latched = latched
        qos = interface_profile(latched=latched, heard=False)
        self._publisher = node.create_publisher(kind, name, qos)

    def until_heard(self, token: CancelToken, timeout_s: float) -> None:
        """Wait for a subscriber, unless it is latched. Raises `SkillFailed`, `Cancelled`."""
        if not self._latched:
            heard = self._publisher.get_subscription_count
            self.until_there(lambda: heard() > 0, token, timeout_s, "nobody_listens")

    def send(self, message: Any) -> None:
        """Publish this."""
        self._publisher.publish(message)


READ_S = 5.0
"""An older message is no answer, unless the topic is latched, which publishes once."""


class TopicListener(InterfaceClient):
    """A topic's subscription, from the moment that it is made; `keeps` is as of `Newest`."""

    def __init__(
        self, node: Node, kind: Any, name: str, clock: Clock, *, latched: bool, keeps: int = 1
    ) -> None:
        super().__init__(node, kind, name, clock)
        self._latched = latched
        self._newest = Newest(clock, keeps)
        qos = interface_profile(latched=latched, heard=True)
        node.create_subscription(kind, name, self._newest.take, qos)

    def newest(self, oldest_s: float = READ_S) -> Any:
        """The newest message, if it is no older, or latched; else None."""
        return self._newest.young(float("inf") if self._latched else oldest_s)

    def latest(self, token: CancelToken, timeout_s: float, oldest_s: float = READ_S) -> Any:
        """The newest message, if it is no older, else the next. Raises `SkillFailed`."""
        message = self.newest(oldest_s)
        if message is not None:
            return message
        try:
            return self._newest.wait(lambda _: True, token, min(READ_S, timeout_s))
        except TookTooLong:
            raise self.failed("unheard") from None

    def wait_for(
        self,
        fits: Callable[[Any], bool],
        token: CancelToken,
        timeout_s: float,
        oldest_s: float = READ_S,
        since_s: float | None = None,
    ) -> Any:
        """The first message that fits, be it the newest, if that is no older.

        With `since_s`, of the `clock`, be it any that has come since then, rather than the newest.
        Raises `SkillFailed`, or `Cancelled`.
        """

        def known() -> Sequence[Any]:
            if since_s is not None and not self._latched:
                return self._newest.since(since_s)
            newest = self.newest(oldest_s)
            return () if newest is None else (newest,)

        try:
            return self._newest.wait(fits, token, timeout_s, known)
        except TookTooLong:
            raise self.failed("not_so") from None


CANCEL_S = 5.0
"""Seconds that a cancelled action may take to end."""
FEEDBACK_DEPTH = 10
"""Feedback messages that may wait for the skill; beyond that, the oldest is lost."""


class GaveUp(SkillFailed):
    """An action ended without success, with this result."""

    def __init__(self, reason: Reason, result: Any) -> None:
        self.result = result
        super().__init__(reason)


class ActionRunner(InterfaceClient):
    """An action's client."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        super().__init__(node, kind, name, clock)
        self._client = ActionClient(node, kind, name)

    def until_ready(self, token: CancelToken, timeout_s: float) -> None:
        """Wait until it is there. Raises `SkillFailed`, or `Cancelled`."""
        self.until_there(self._client.server_is_ready, token, timeout_s, "not_there")

    def run(
        self,
        goal: Any,
        token: CancelToken,
        timeout_s: float,
        hear: Callable[[Any], None] = lambda _: None,
        give_up: Callable[[], None] = lambda: None,
    ) -> Any:
        """Run the action and return its result; `hear` gets its feedback, on the calling thread.

        `give_up` is called when an accepted goal was cancelled and may still be running.

        Raises `SkillFailed` with the reason, `Cancelled`, or the error of `hear`. In each of these
        cases the action has been cancelled, and has ended if it did so within `CANCEL_S`. `GaveUp`
        has the result of an action that ended without success.
        """
        self.until_ready(token, timeout_s)
        until_s = self._clock.now() + timeout_s
        feedback = _Feedback()
        sent = self._ask(lambda: self._client.send_goal_async(goal, feedback.take))
        try:
            handle = wait_for(sent, token, timeout_s)
        except (TookTooLong, Cancelled) as end:
            sent.add_done_callback(_cancel_late)
            raise end if isinstance(end, Cancelled) else self.failed("no_answer") from None
        if not handle.accepted:
            raise self.failed("refused")
        ended = self._ask(handle.get_result_async)
        try:
            self._follow(ended, feedback, token, until_s, hear)
        except BaseException as end:
            self._cancel(handle, ended, give_up)
            if isinstance(end, TookTooLong):
                raise self.failed("no_answer") from None
            raise
        if ended.result().status != GoalStatus.STATUS_SUCCEEDED:
            raise GaveUp(self.failed("gave_up").reason, ended.result().result)
        return ended.result().result

    def _follow(
        self,
        ended: RosFuture,
        feedback: "_Feedback",
        token: CancelToken,
        until_s: float,
        hear: Callable[[Any], None],
    ) -> None:
        """Hand on the feedback until it has ended. Raises `Cancelled`, or `TookTooLong`."""
        ended.add_done_callback(lambda _: feedback.wake())
        forget = token.on_cancel(feedback.wake)
        try:
            while not ended.done():
                token.check()
                if (left_s := until_s - self._clock.now()) <= 0:
                    raise TookTooLong
                for one in feedback.wait(left_s):
                    hear(one)
        finally:
            forget()

    def _ask(self, ask: Callable[[], RosFuture]) -> RosFuture:
        """Ask on the node's thread: rclpy loses an answer that comes before it noted the question.

        Raises `SkillFailed`.
        """
        try:
            return on_node_thread(self._node, lambda _: ask())
        except NodeBusy:
            raise self.failed("no_answer") from None

    def _cancel(self, handle: Any, ended: RosFuture, give_up: Callable[[], None]) -> None:
        with contextlib.suppress(SkillFailed):
            self._ask(handle.cancel_goal_async)
        give_up()
        with contextlib.suppress(TookTooLong):
            wait_for(ended, CancelToken(), CANCEL_S)
        if not ended.done():
            log.error("action_not_cancelled", interface=self.name, waited_s=CANCEL_S)


class _Feedback:
    """A queue of feedback from the node's thread, which must not wait, to the skill's."""

    def __init__(self) -> None:
        self._changed = threading.Event()
        self._messages: deque[Any] = deque(maxlen=FEEDBACK_DEPTH)

    def take(self, message: Any) -> None:
        self._messages.append(message.feedback)
        self._changed.set()

    def wake(self) -> None:
        self._changed.set()

    def wait(self, timeout_s: float) -> list[Any]:
        """Wait for a message or `wake`; return the messages since the last call."""
        self._changed.wait(timeout_s)
        self._changed.clear()
        return [self._messages.popleft() for _ in range(len(self._messages))]


def _cancel_late(sent: RosFuture) -> None:
    """Cancel a goal that is accepted after the caller has stopped waiting."""
    if sent.exception() is None and sent.result() is not None and sent.result().accepted:
        sent.result().cancel_goal_async()
