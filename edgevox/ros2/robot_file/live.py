"""The run of a robot file's skill on a node: its steps in order, its end conditions, its stop step.

A step publishes, calls, runs an action, reads or waits. `values_of` takes the wanted values from a
step's answer, and tests the expected conditions.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from rclpy.node import Node

from edgevox.agent.skills import GoalHandle, SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.ros2.clients import (
    READ_S,
    ActionRunner,
    GaveUp,
    Newest,
    ServiceCaller,
    TopicListener,
    TopicSender,
    interface_reason,
)
from edgevox.ros2.messages import interface_profile
from edgevox.ros2.robot_file.messages import (
    Filling,
    constant,
    converted,
    with_arguments,
)
from edgevox.ros2.robot_file.paths import LONGEST_TEXT, brief, owner_of, read_path
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.steps import (
    ActionInterface,
    Comparison,
    FieldCondition,
    Progress,
    Publication,
    ResultValue,
    Topic,
    Wait,
)

log = get_logger(__name__)


def holds(message: Any, conditions: Sequence[FieldCondition], arguments: Mapping[str, Any]) -> bool:
    """Return whether all conditions hold for a message; `arguments` are values that they name."""
    return all(_one_holds(message, one, arguments) for one in conditions)


def _one_holds(message: Any, condition: FieldCondition, arguments: Mapping[str, Any]) -> bool:
    value = read_path(message, condition.field, arguments)
    if condition.equals is not None:
        wanted = with_arguments(condition.equals, arguments)
        if isinstance(wanted, str) and not isinstance(value, str):
            wanted = constant(owner_of(type(message), condition.field), wanted)
        return compares(value, condition, wanted)
    return compares(value, condition, None)


def compares(value: Any, how: Comparison, equals: Any) -> bool:
    """Whether a value is as wanted; `equals` is what it has to equal, unless that is None."""
    if how.equals is not None:
        return bool(value == equals)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    above = how.above is None or value > how.above
    return above and (how.below is None or value < how.below)


class StepFailed(SkillFailed):
    """A step failed; `values` are the results that are known all the same."""

    def __init__(self, reason: Reason, values: Mapping[str, Any]) -> None:
        self.values = values
        super().__init__(reason)


def values_of(planned: PlannedStep, message: Any, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return a step's results, as JSON values; `arguments` are values that conditions may name.

    Raises `StepFailed` if the answer says that it was not done.
    """
    what = planned.interface_name
    results = {n: value_of(message, one, arguments) for n, one in planned.step.values.items()}
    said_no = planned.way == "call" and getattr(message, "success", True) is False
    if said_no or not holds(message, planned.step.expect, {**arguments, **results}):
        log.warning("interface_refused", interface=what, answer=str(brief(message))[:LONGEST_TEXT])
        raise StepFailed(interface_reason("refused", what=what), results)
    return results


def value_of(message: Any, how: ResultValue, arguments: Mapping[str, Any] | None = None) -> Any:
    """Return a value of the answer as JSON, not longer than `brief`.

    None if a list is shorter, and for NaN, as of a sensor that sees nothing. `arguments` are values
    that its path may name.
    """
    value = read_path(message, how.field, arguments)
    if how.count:
        return None if value is None else len(value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        value = converted(value, how.times, how.plus)
    value = brief(value)
    if isinstance(value, float):
        return round(value, how.decimals) if how.decimals else round(value)
    return value


Report = Callable[..., None]


@dataclass(frozen=True, slots=True)
class StepRun:
    """A single run of a step."""

    values: Mapping[str, Any]
    """Values for the request, by name."""
    token: CancelToken
    """Cancelled with the goal."""
    report: Report
    stop: Callable[[], None] = lambda: None
    """Does what the skill does when it ends early; only the first call counts."""
    asked_s: float | None = None
    """When the step before began to ask for something, by the clock; None if it did not."""
    only_asked: bool = False
    """True if the step before did not wait for what it asked for."""


class LiveStep(Protocol):
    """A step that can be done. `run` blocks, on a thread that is not the node's."""

    @property
    def only_asks(self) -> bool:
        """Whether it ends as soon as it has asked for something."""

    def until_there(self, token: CancelToken, most_s: float) -> None:
        """Wait so long until what it asks is there. Raises `SkillFailed`, or `Cancelled`."""

    def run(self, run: StepRun) -> dict[str, Any]:
        """Run the step; return its results.

        Raises `SkillFailed` with the reason, or `Cancelled`.
        """


def go_live(planned: PlannedStep, node: Node, clock: Clock) -> LiveStep:
    """A step on this node, which is not yet spun, or on the thread that spins it."""
    return _KINDS[planned.way](planned, node, clock)


class _Base:
    only_asks = False

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        self._planned, self._step, self._clock = planned, planned.step, clock
        self._filling = Filling(lambda: node.get_clock().now().to_msg())

    def until_there(self, token: CancelToken, most_s: float) -> None:
        """What only listens asks nothing."""

    def _request(self, run: StepRun) -> Any:
        return self._filling.fill(self._planned.request(), self._step.request, run.values)


class Publishes(_Base):
    """Publishes once, or at a rate until its time is over or it is stopped."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        self._how: Publication = getattr(self._step, planned.way)
        self._sender = TopicSender(
            node, planned.type, planned.interface_name, clock, latched=self._how.latched
        )
        self.only_asks = not self._how.rate_hz

    def until_there(self, token: CancelToken, most_s: float) -> None:
        self._sender.until_heard(token, most_s)

    def run(self, run: StepRun) -> dict[str, Any]:
        message = self._request(run)
        self.until_there(run.token, self._step.timeout_s)
        try:
            self._repeat(message, run)
        finally:
            if self._how.at_end is not None:
                end = self._filling.fill(self._planned.request(), self._how.at_end, run.values)
                self._sender.send(end)
        return {}

    def _repeat(self, message: Any, run: StepRun) -> None:
        run.token.check()
        self._sender.send(message)
        begun_s = self._clock.now()
        while self._how.rate_hz:
            passed_s = self._clock.now() - begun_s
            if self._how.for_s and passed_s >= self._how.for_s:
                return
            if run.token.wait(1.0 / self._how.rate_hz):
                run.token.check()
            self._sender.send(message)
            if self._how.for_s:
                run.report(progress=round(min(1.0, passed_s / self._how.for_s), 3))


class Calls(_Base):
    """Calls a service."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        self._service = ServiceCaller(node, planned.type, planned.interface_name, clock)

    def until_there(self, token: CancelToken, most_s: float) -> None:
        self._service.until_ready(token, most_s)

    def run(self, run: StepRun) -> dict[str, Any]:
        answer = self._service.call(self._request(run), run.token, self._step.timeout_s, run.stop)
        return values_of(self._planned, answer, run.values)


class Acts(_Base):
    """Runs an action; a stop cancels it and waits until it has ended."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        how: ActionInterface = getattr(self._step, planned.way)
        self._progress, self._tells = how.part_done, how.tells
        self._action = ActionRunner(node, planned.type, planned.interface_name, clock)

    def until_there(self, token: CancelToken, most_s: float) -> None:
        self._action.until_ready(token, most_s)

    def run(self, run: StepRun) -> dict[str, Any]:
        part_done = progress_of(self._progress) if self._progress else None
        try:
            result = self._action.run(
                self._request(run),
                run.token,
                self._step.timeout_s,
                lambda feedback: self._hear(feedback, run, part_done),
                run.stop,
            )
        except GaveUp as error:
            known = self._step.values.items()
            values = {name: value_of(error.result, one, run.values) for name, one in known}
            raise StepFailed(error.reason, values) from error
        return values_of(self._planned, result, run.values)

    def _hear(self, feedback: Any, run: StepRun, part_done: "PartDone | None") -> None:
        if run.token.cancelled:
            return
        told: dict[str, Any] = {}
        if part_done is not None and (part := part_done(feedback)) is not None:
            told["progress"] = part
        if self._tells and (text := brief(read_path(feedback, self._tells, run.values))):
            told["text"] = text
        if told:
            run.report(**told)


PartDone = Callable[[Any], float | None]
"""How much of a run is done by its feedback, from 0 to 1; None if the feedback does not tell."""


def progress_of(how: Progress) -> PartDone:
    """What tells how much of one run is done: it remembers the number that it counts down from."""
    first: list[float] = []

    def whole(feedback: Any, value: float) -> float:
        if isinstance(how.of, str):
            found = read_path(feedback, how.of)
            return float(found) if isinstance(found, int | float) else 0.0
        if how.of is not None or not how.down:
            return how.of or 1.0
        if not first:
            first.append(value)
        return first[0]

    def part_done(feedback: Any) -> float | None:
        value = value_of(feedback, how)
        if not isinstance(value, int | float) or not (of := whole(feedback, value)):
            return None
        part = 1.0 - value / of if how.down else value / of
        return round(float(part), 3) if 0.0 <= part <= 1.0 else None

    return part_done


class _Hears(_Base):
    keeps = 1

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        topic: Topic = getattr(self._step, planned.way)
        self._listener = TopicListener(
            node,
            planned.type,
            planned.interface_name,
            clock,
            latched=topic.latched,
            keeps=self.keeps,
        )


class Reads(_Hears):
    """Answers with the newest message of a topic."""

    def run(self, run: StepRun) -> dict[str, Any]:
        message = self._listener.latest(run.token, self._step.timeout_s)
        return values_of(self._planned, message, run.values)


class WaitsForMessage(_Hears):
    """Waits until a message says that something is so."""

    keeps = 32
    """Messages kept between asking and waiting: others' answers come on the same topic."""

    def run(self, run: StepRun) -> dict[str, Any]:
        how: Wait = getattr(self._step, self._planned.way)
        # After another step only what came since is an answer to it, also if it was there at once.
        # What it asked for may be followed by others' answers; of what is said again and again
        # while it takes its time, only the newest is so.
        oldest_s = READ_S if run.asked_s is None else self._clock.now() - run.asked_s
        message = self._listener.wait_for(
            lambda one: holds(one, how.until, run.values),
            run.token,
            self._step.timeout_s,
            min(READ_S, oldest_s),
            since_s=run.asked_s if run.only_asked else None,
        )
        return values_of(self._planned, message, run.values)


_KINDS: Mapping[str, Callable[[PlannedStep, Node, Clock], LiveStep]] = {
    "publish": Publishes,
    "call": Calls,
    "action": Acts,
    "read": Reads,
    "wait": WaitsForMessage,
}


class Watch:
    """A message that ends a skill, such as that of a bumper."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        self.name = planned.interface_name
        self._how: Wait = getattr(planned.step, planned.way)
        self._newest = Newest(clock)
        self._lock = threading.Lock()
        self._runs: tuple[Callable[[Watch], None], ...] = ()
        qos = interface_profile(latched=self._how.latched, heard=True)
        node.create_subscription(planned.type, self.name, self._take, qos)

    @property
    def so_now(self) -> bool:
        """Whether the last recent message would end the skill."""
        newest = self._newest.young(float("inf") if self._how.latched else READ_S)
        return newest is not None and holds(newest, self._how.until, {})

    def tell(self, run: Callable[["Watch"], None]) -> Callable[[], None]:
        """Tell this of each such message from now on, on the node's thread; what ends that."""
        with self._lock:
            self._runs = (*self._runs, run)
        return lambda: self._forget(run)

    def _forget(self, run: Callable[["Watch"], None]) -> None:
        with self._lock:
            self._runs = tuple(one for one in self._runs if one != run)

    def _take(self, message: Any) -> None:
        self._newest.take(message)
        runs = self._runs
        if runs and holds(message, self._how.until, {}):
            for run in runs:
                run(self)


@dataclass(frozen=True)
class LiveSkill:
    """The steps of a skill on a node, its end conditions, and its stop step."""

    name: str
    steps: Sequence[LiveStep]
    stop: LiveStep | None
    watches: Sequence[Watch]
    clock: Clock


def run_skill(skill: LiveSkill, goal: GoalHandle, values: Mapping[str, Any]) -> dict[str, Any]:
    """Do all steps; their results. Raises `SkillFailed`, or `Cancelled`."""
    run = _SkillRun(skill, goal, values)
    try:
        return run.steps()
    except Cancelled as cancelled:
        run.stop()
        if run.ended_by and not goal.token.cancelled:
            log.warning("skill_ended_by", skill=skill.name, interface=run.ended_by)
            reason = interface_reason("ended_by", what=run.ended_by)
            raise SkillFailed(reason) from cancelled
        raise
    finally:
        run.close()


class _SkillRun:
    """`ended_by` is the interface that ended it; empty if none did."""

    def __init__(self, skill: LiveSkill, goal: GoalHandle, values: Mapping[str, Any]) -> None:
        self._skill, self._goal, self._values = skill, goal, values
        self._token = goal.token.child()
        self._forgets: list[Callable[[], None]] = []
        self._begun = False
        self._stopped = False
        self.ended_by = ""

    def steps(self) -> dict[str, Any]:
        for watch in self._skill.watches:
            self._forgets.append(watch.tell(self._end))
            if watch.so_now:
                self._end(watch)
        results: dict[str, Any] = {}
        asked_s: float | None = None
        only_asked = False
        for step in self._skill.steps:
            self._token.check()
            self._begun = True
            values = {**self._values, **results}
            run = StepRun(values, self._token, self._goal.report, self.stop, asked_s, only_asked)
            asked_s, only_asked = self._skill.clock.now(), step.only_asks
            try:
                results |= step.run(run)
            except StepFailed as error:
                raise StepFailed(error.reason, {**results, **error.values}) from error
            except SkillFailed as error:
                raise StepFailed(error.reason, results) from error
        return results

    def stop(self) -> None:
        """Do the file's stop step, for an early end: once, and only after the skill has begun."""
        if self._skill.stop is None or self._stopped or not self._begun:
            return
        self._stopped = True
        try:
            self._skill.stop.run(StepRun(self._values, CancelToken(), lambda **_: None))
        except SkillFailed as error:
            log.error("stop_step_failed", skill=self._skill.name, reason=str(error))  # noqa: TRY400

    def close(self) -> None:
        for forget in self._forgets:
            forget()
        self._token.detach()

    def _end(self, watch: Watch) -> None:
        self.ended_by = self.ended_by or watch.name
        self._token.cancel()
