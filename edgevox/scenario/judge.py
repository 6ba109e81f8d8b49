"""Judges a scenario from what is seen, and from nothing else: no clock, no thread, no robot.

Whoever watches (the runner in this process, a recorder on ROS 2) feeds it what it sees, in order,
with the robot's time, and asks.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from edgevox.scenario.format import MISSING, Condition, Never, Value, look_up

MOST_REMEMBERED = 10_000
"""How many answers and events since the last stimulus an expectation may look back on."""


class Source(StrEnum):
    """Where something is seen; also the name of a condition's part."""

    STATE = "state"
    """`robot_state`, a mapping."""
    ANSWER = "answer"
    """`response`, a text."""
    EVENT = "event"
    """`agent_event`, a mapping with its ``kind``."""


@dataclass(frozen=True, slots=True)
class Seen:
    """Something that was seen, at the robot's time."""

    time_s: float
    source: Source
    data: Any


class ConditionWatch:
    """One condition, from its beginning to its deadline, both in the robot's time."""

    def __init__(self, condition: Condition, deadline_s: float) -> None:
        self.condition = condition
        self.deadline_s = deadline_s
        self._missing = {Source(name) for name in condition.model_fields_set}
        self._last: dict[Source, Seen] = {}

    @property
    def met(self) -> bool:
        """Whether each part came true in time."""
        return not self._missing

    def see(self, seen: Seen) -> None:
        """Take something that was seen."""
        if seen.source not in self._missing or seen.time_s > self.deadline_s:
            return
        self._last[seen.source] = seen
        if holds(self.condition, seen):
            self._missing.discard(seen.source)

    def explain(self) -> list[str]:
        """What was expected and did not come true, and what was seen instead, in lines."""
        missing = (source for source in Source if source in self._missing)
        seen = (describe(self.condition, source, self._last.get(source)) for source in missing)
        return [f"expected {self.condition}", *(f"last seen: {one}" for one in seen)]


class Judge:
    """Remembers what a new expectation may still count, and looks out for what must never be."""

    def __init__(self, never: Sequence[Never] = ()) -> None:
        self._never = never
        self._unseen = {path for one in never for path in one.state or ()}
        self._recent: deque[Seen] = deque(maxlen=MOST_REMEMBERED)
        self._state: Seen | None = None
        self._watch: ConditionWatch | None = None
        self.broken: tuple[Never, Seen] | None = None

    def stimulus(self) -> None:
        """Something is done to the robot: what was answered and done before does not count."""
        self._recent.clear()

    @property
    def never_looked(self) -> tuple[str, ...]:
        """Paths of what must never be that `robot_state` never had: nothing was judged there."""
        return tuple(sorted(self._unseen)) if self._state else ()

    def expect(self, condition: Condition, now_s: float, within_s: float) -> ConditionWatch:
        """Watch for this from now on; the state as it is now counts as well."""
        self._watch = ConditionWatch(condition, now_s + within_s)
        for seen in (*self._recent, *([self._state] if self._state else [])):
            self._watch.see(seen)
        return self._watch

    def see(self, seen: Seen) -> None:
        """Take something that was seen."""
        if seen.source is Source.STATE:
            self._state = seen
            self._unseen -= {p for p in self._unseen if look_up(p, seen.data) is not MISSING}
        else:
            self._recent.append(seen)
        if self._watch:
            self._watch.see(seen)
        if self.broken is None:
            found = [one for one in self._never if holds(one, seen)]
            self.broken = (found[0], seen) if found else None


def holds(condition: Condition, seen: Seen) -> bool:
    """Whether that part of a condition which is about this source is true of what was seen."""
    match seen.source:
        case Source.ANSWER:
            return condition.answer is not None and condition.answer.holds(seen.data)
        case Source.STATE:
            return _all_hold(condition.state, seen.data)
        case Source.EVENT:
            return _all_hold(condition.event, seen.data)


def describe(condition: Condition, source: Source, seen: Seen | None) -> str:
    """What was seen where a part of a condition looks."""
    if seen is None:
        return f"no {source}"
    if source is Source.ANSWER:
        said = f"answer {seen.data!r}"
    else:
        paths = condition.state if source is Source.STATE else condition.event
        said = ", ".join(f"{path} = {look_up(path, seen.data)!r}" for path in paths or ())
        said = said if source is Source.STATE else f"event with {said}"
    return f"{said}, at {seen.time_s:.2f} s"


def _all_hold(wanted: Mapping[str, Value] | None, data: Mapping[str, Any]) -> bool:
    return wanted is not None and all(one.holds(look_up(p, data)) for p, one in wanted.items())
