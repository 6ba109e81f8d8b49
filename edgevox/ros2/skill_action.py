"""The action `execute_skill`: one skill, run for a program, with feedback, a result and cancel.

`ClientWatch` notices that a client is gone: ROS 2 does not tell a server that its client died.
"""

import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Protocol

from rclpy.action.server import (
    ActionServer,
    CancelResponse,
    GoalEvent,
    GoalResponse,
    ServerGoalHandle,
)
from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future

from edgevox.agent.skills import STOP, reason_of
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import (
    GOAL_ENDS,
    AgentEvent,
    GoalCancelled,
    GoalChanged,
    GoalRejected,
    GoalStatus,
    as_json,
    reason_json,
)
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Way
from edgevox.core.errors import EdgeVoxError, shorten
from edgevox.core.files.validation import read_json_object
from edgevox.core.log import get_logger
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.contract import ACTION, write

log = get_logger(__name__)

MAX_ARGUMENTS_BYTES = 64 * 1024
"""The longest `arguments_json` that is read."""


class RunningGoal(Protocol):
    """A goal that was started."""

    @property
    def token(self) -> CancelToken:
        """Ends it when cancelled."""


class StartsGoals(Protocol):
    """Runs skills, as the conversation does. Both methods raise `EdgeVoxError` with the reason."""

    def check_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> None:
        """Raise what `start_goal` would raise; but that a refusal is told, nothing happens."""

    def start_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        goal_id: str | None = None,
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> RunningGoal:
        """Run a skill. Does not block; the bus tells of it under this id from now on.

        `mark` is the interlock's when it was received, now by default.
        """


def read_arguments(text: str, skill: str = "") -> dict[str, Any]:
    """The arguments in `arguments_json`; empty means none. Raises `InvalidValue`.

    Of the `skill` that stops nothing is read: a stop with wrong arguments is still a stop.
    """
    if skill == STOP:
        return {}
    if len(text) <= MAX_ARGUMENTS_BYTES and not text.strip():
        return {}
    return read_json_object(text, "arguments_json", largest_bytes=MAX_ARGUMENTS_BYTES)


def mirror(event: AgentEvent) -> str:
    """The feedback that mirrors an `agent_event`, with its ``progress`` on top where it has one."""
    data = as_json(event)
    progress = data.get("feedback", {}).get("progress")
    return write(data | ({} if progress is None else {"progress": progress}))


LOOK_EVERY_S = 0.5
GRACE_S = 2.0
"""Seconds without a client in the graph; discovery may lag behind the first request."""


class ClientWatch:
    """Calls `gone` when a service has had no client at all for a while.

    The graph counts a service's clients and does not name them: while another client of the same
    service lives, the death of one is not seen. The graph drops a client that leaves at once, and a
    killed one when the middleware gives it up, with Fast DDS after 20 s. Call it on the executor's
    thread.
    """

    def __init__(self, node: Node, service: str, gone: Callable[[], None]) -> None:
        self._node = node
        self._service = node.resolve_service_name(service)  # the graph knows its remapped name
        self._gone = gone
        self._alone_for_s = 0.0
        # Real time: a paused simulation must not hide a client's death.
        self._timer = node.create_timer(
            LOOK_EVERY_S, self._look, clock=RosClock(clock_type=ClockType.STEADY_TIME)
        )
        self._timer.cancel()

    def begin(self) -> None:
        """Look from now on."""
        if self._timer.is_canceled():
            self._alone_for_s = 0.0
            self._timer.reset()

    def end(self) -> None:
        """Look no more."""
        self._timer.cancel()

    def _look(self) -> None:
        if self._node.count_clients(self._service):
            self._alone_for_s = 0.0
            return
        self._alone_for_s += LOOK_EVERY_S
        if self._alone_for_s >= GRACE_S:
            self.end()
            self._gone()


NAME, _ = ACTION
FEEDBACK_EVERY_S = 0.05
"""Reports of progress that follow each other faster are left out; changes of status never are."""
REQUESTS = QoSProfile(depth=100)
"""ROS 2's own 10 would lose the eleventh request of a burst, and its client would wait for ever."""
CLOSING_S = 1.0
"""Seconds that `close` waits for the executor's remaining work."""


class _ActionRun:
    """An accepted goal: its handle on the wire, what runs for it, and how it will have ended."""

    def __init__(self, handle: ServerGoalHandle) -> None:
        self.handle = handle
        self.goal: RunningGoal | None = None
        self.ended = Future()
        self.status: GoalStatus | None = None
        self.told_s = 0.0


class _Server(ActionServer):
    """rclpy's, which can also be asked for a request that waits."""

    def take_request(self) -> bool:
        """Handle one request for a goal, as the executor would; False if none waits.

        There is no public method for it.
        """
        with self._lock:
            taken = self._handle.take_goal_request(self._action_type.Impl.SendGoalService.Request)
        if not all(taken):
            return False
        with suppress(StopIteration):  # it awaits plain functions only, and so ends at once
            self._execute_goal_request(taken).send(None)
        return True


class SkillAction:
    """Serves `execute_skill` on a node whose executor runs in one thread.

    No callback blocks. A goal has the same id here and in `agent_event`, in hexadecimal. A goal
    ends as aborted when the skill fails. It ends as canceled by its client, a newer goal, a
    sentence that moves the robot, a stop word, an interrupt, or the end of its client.
    """

    def __init__(
        self,
        node: Node,
        bus: Bus,
        goals: StartsGoals,
        kind: Any,
        *,
        backlog: Backlog,
        clock: Clock | None = None,
    ) -> None:
        self._node = node
        self._bus = bus
        self._goals = goals
        self._kind = kind
        self._clock = clock or SystemClock()
        self._runs: dict[str, _ActionRun] = {}
        self._idle = threading.Event()
        self._idle.set()
        self._server = _Server(
            node,
            kind,
            NAME,
            execute_callback=self._execute,
            goal_callback=self._judge,
            handle_accepted_callback=self._accept,
            cancel_callback=self._cancel,
            goal_service_qos_profile=REQUESTS,
            cancel_service_qos_profile=REQUESTS,
            result_service_qos_profile=REQUESTS,
        )
        self._queue = backlog.add(self._server.take_request, REQUESTS.depth)
        self._watch = ClientWatch(node, f"{NAME}/_action/get_result", self._client_gone)
        self._forget = bus.subscribe(GoalChanged | GoalCancelled, self._hear)

    def close(self) -> None:
        """Give the ends of goals a moment to leave, then take no more."""
        self._idle.wait(CLOSING_S)
        self._forget()
        self._there(lambda: None)  # the executor sends the last results in this round of its tasks
        # Destroyed by another thread, it would fail a wait of the executor that begins just then.
        self._there(self._destroy)

    def _destroy(self) -> None:
        self._watch.end()
        self._server.destroy()

    def _there(self, work: Callable[[], None]) -> None:
        """Do it on the executor's thread, and wait for it unless that thread is gone."""
        done = threading.Event()
        if self._node.executor:
            self._node.executor.create_task(work).add_done_callback(lambda _: done.set())
            done.wait(CLOSING_S)

    def _judge(self, request: Any) -> GoalResponse:
        try:
            with self._queue.served() as mark:
                name = request.skill_name
                given = read_arguments(request.arguments_json, name)
                self._goals.check_goal(name, given, mark=mark)
        except EdgeVoxError as error:
            log.warning("action_goal_rejected", skill=request.skill_name[:80], reason=str(error))
            rejected = GoalRejected(
                request.skill_name[:80],
                shorten(request.arguments_json),
                reason_of(error),
                way=str(Way.ACTION),
            )
            self._bus.publish(rejected)
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _accept(self, handle: ServerGoalHandle) -> None:
        goal_id = _key(handle)
        run = self._runs[goal_id] = _ActionRun(
            handle
        )  # before it starts: none of its events is missed
        self._idle.clear()
        handle.execute()
        self._watch.begin()
        try:
            name = handle.request.skill_name
            arguments = read_arguments(handle.request.arguments_json, name)
            with self._queue.served() as mark:
                run.goal = self._goals.start_goal(name, arguments, goal_id, mark=mark)
        except EdgeVoxError as error:
            failed = GoalStatus.FAILED
            name = handle.request.skill_name
            self._end(run, GoalChanged(goal_id, name, {}, failed, 0, reason=reason_of(error)))

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        run = self._runs.get(_key(handle))
        if run is None or run.goal is None:
            return CancelResponse.REJECT
        run.goal.token.cancel(because("client_asked"))
        return CancelResponse.ACCEPT

    def _client_gone(self) -> None:
        for run in list(self._runs.values()):
            if run.goal:
                run.goal.token.cancel(because("client_gone"))

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        """Wait for the goal's end without holding up the executor, and say how it ended."""
        goal_id = _key(handle)
        end: GoalChanged | GoalCancelled = await self._runs[goal_id].ended
        match end.status:
            case GoalStatus.SUCCEEDED:
                handle.succeed()
            case GoalStatus.CANCELLED:
                _end_as_canceled(handle)
            case _:
                handle.abort()
        del self._runs[goal_id]
        if not self._runs:
            self._watch.end()
            self._idle.set()
        return self._kind.Result(
            ok=end.status is GoalStatus.SUCCEEDED,
            result_json=write(_result(end)),
            error=str(end.reason or ""),
        )

    def _hear(self, event: GoalChanged | GoalCancelled) -> None:
        """Take an event of the bus, on whatever thread it happens."""
        run = self._runs.get(event.goal_id)
        if run is None:
            return
        try:
            self._tell(run, event)
        finally:
            if event.status in GOAL_ENDS:
                self._end(run, event)

    def _tell(self, run: _ActionRun, event: GoalChanged | GoalCancelled) -> None:
        now_s, status = self._clock.now(), event.status
        if status == run.status and now_s - run.told_s < FEEDBACK_EVERY_S:
            return
        run.status, run.told_s = status, now_s
        feedback = mirror(event)
        run.handle.publish_feedback(self._kind.Feedback(feedback_json=feedback))

    def _end(self, run: _ActionRun, end: GoalChanged | GoalCancelled) -> None:
        run.ended.set_result(end)
        if self._node.executor:
            self._node.executor.wake()  # a future that is set on another thread wakes nobody


def open_skill_action(
    node: Node, bus: Bus, goals: StartsGoals, backlog: Backlog
) -> SkillAction | None:
    """The action, or None and a line in the log where its interface is not built."""
    try:
        # Where it is not built, the folder of its sources may answer to its name, without this.
        from edgevox_msgs.action import ExecuteSkill
    except ImportError as error:
        missing = (error.name or "").startswith("edgevox_msgs")
        reason = "edgevox_msgs is not built; make msgs" if missing else str(error)
        log.warning("action_off", action=NAME, reason=reason)
        return None
    return SkillAction(node, bus, goals, ExecuteSkill, backlog=backlog)


def _result(end: GoalChanged | GoalCancelled) -> Mapping[str, Any]:
    """Return the skill's result, or a failure's code with its values."""
    if isinstance(end, GoalCancelled):
        return {}
    if end.reason is None:
        return end.result or {}
    found = reason_json(end.reason)
    del found["error"]
    return found


def _key(handle: ServerGoalHandle) -> str:
    return bytes(handle.goal_id.uuid).hex()


def _end_as_canceled(handle: ServerGoalHandle) -> None:
    """End it as canceled, also where the client did not ask for it.

    The state machine of actions knows no way from EXECUTING to CANCELED but through CANCELING, and
    rclpy takes that step only for a cancel request; there is no public method for it.
    """
    if not handle.is_cancel_requested:
        handle._update_state(GoalEvent.CANCEL_GOAL)  # noqa: SLF001
    handle.canceled()
