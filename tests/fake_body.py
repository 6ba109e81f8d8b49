"""The body of tests that are about a conversation: it drives and tells where it is."""

import math
import threading
from collections.abc import Callable
from typing import Annotated, Any

from guards import HUNG_S

from edgevox.agent.skills import GoalHandle, OneOf, SkillFailed, SkillSet, skill

ROOMS = OneOf(("kitchen", "living_room", "bedroom", "office"))
REPORT_S = 0.002


class FakeBody:
    """Drives until it is let `arrive` or cancelled, and remembers where it was `sent`.

    Where it arrived it has `visited`; it leaves for nowhere as long as its door is `locked`.
    `on_halt` is called when it is halted. With `reports` a drive says all the time how far it is.
    """

    def __init__(self, *, arrives: bool = False, reports: bool = False) -> None:
        self.sent: list[Any] = []
        self.visited: list[Any] = []
        self.locked = False
        self.moving = False
        self.on_halt: Callable[[], object] = lambda: None
        self._arrivals = math.inf if arrives else 0
        self._reports = reports
        self._started = threading.Semaphore(0)
        self._changed = threading.Condition()

    def halt(self, reason: str) -> bool:
        self.on_halt()
        moved, self.moving = self.moving, False
        return moved

    def starts(self) -> None:
        """Wait until it has begun to drive, once more than it was waited for before."""
        assert self._started.acquire(timeout=HUNG_S), "no drive began"

    def starts_until(self, count: int) -> None:
        """Wait until it has begun to drive so many times."""
        with self._changed:
            assert self._changed.wait_for(lambda: len(self.sent) >= count, HUNG_S), self.sent

    def starts_until_driving(self, where: Any) -> None:
        """Wait until it has begun to drive there."""
        with self._changed:
            assert self._changed.wait_for(lambda: where in self.sent, HUNG_S), self.sent

    def arrive(self, times: float = math.inf) -> None:
        """Let so many drives come to their end, those that begin later too: all of them."""
        with self._changed:
            self._arrivals += times
            self._changed.notify_all()

    def drive_on(self) -> None:
        """No drive comes to its end by itself from now on."""
        with self._changed:
            self._arrivals = 0

    def drive(self, goal: GoalHandle, where: Any) -> None:
        """Raises `Cancelled`, and `SkillFailed` where the door is locked."""
        if self.locked:
            raise SkillFailed("the door is locked")
        with self._changed:
            self.moving = True
            self.sent.append(where)
            self._changed.notify_all()
        forget = goal.token.on_cancel(self._notify)
        self._started.release()
        self._wait_for_its_end(goal)
        forget()
        with self._changed:
            self.moving = False
            goal.token.check()
            self._arrivals -= 1
            self.visited.append(where)

    def skills(self, *names: str) -> SkillSet:
        """Those of its skills that have these names."""

        @skill(
            templates=["go to [the] {room}"],
            says="Going to the {room}.",
            done="I am in the {room}.",
            action="go to the {room}",
        )
        def navigate_to(goal: GoalHandle, room: Annotated[str, ROOMS]):
            """Drive to a room."""
            self.drive(goal, room)
            return {"room": room, "far": float("inf")}

        def walkable(distance: float) -> None:
            if distance > 9:
                raise SkillFailed("that is too far")

        @skill(
            templates=["walk {distance} meters", "go ahead"],
            says="Walking {distance:g} metres.",
            done="I walked.",
            action="walk {distance:g} metres forward",
            check=walkable,
        )
        def walk_forward(goal: GoalHandle, distance: float = 1.0):
            """Walk forward."""
            self.drive(goal, distance)

        @skill(templates=["do your dance"], says="Dancing.")
        def dance(goal: GoalHandle):
            """Dance."""
            self.drive(goal, "dance")

        @skill(templates=["open the door"], says="Opening the door.")
        def open_door(goal: GoalHandle):
            """Open the door."""
            raise SkillFailed("the door is locked")

        @skill(templates=["where are you"], done="I am at {x:.1f}.", moves=False)
        def get_pose(goal: GoalHandle):
            """Say where it is."""
            return {"x": 1.25}

        @skill(templates=["stay there"], says="Stopping.")
        def stop(goal: GoalHandle):
            """Stand."""
            self.sent.append("stop")

        known = {
            one.name: one for one in (navigate_to, walk_forward, dance, open_door, get_pose, stop)
        }
        return SkillSet([known[name] for name in names])

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()

    def _wait_for_its_end(self, goal: GoalHandle) -> None:
        def over() -> bool:
            return self._arrivals > 0 or goal.token.cancelled

        while not over():
            if self._reports:
                goal.report(progress=0.5)
            with self._changed:
                self._changed.wait_for(over, REPORT_S if self._reports else HUNG_S)
