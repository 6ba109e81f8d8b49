"""The body of tests that are about a conversation: it drives, takes things, tells where it is."""

import math
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Any

from guards import HUNG_S
from pydantic import Field

from edgevox.agent.skills import GoalHandle, OneOf, Skill, SkillFailed, SkillSet, skill
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D

ROOMS = ("kitchen", "living_room", "bedroom", "office")
CUBES = ("red_cube", "green_cube", "blue_cube")
BINS = ("left_bin", "right_bin")
REPORT_S = 0.002
PROGRESS = 0.5


class FakeBody:
    """Drives until it is let `arrive` or cancelled, and remembers where it was `sent`.

    Where it arrived it has `visited`; it leaves for nowhere as long as its door is `locked`. A
    drive that begins while it is `quick` arrives at once. `on_halt` is called when it is halted.
    With `reports` a drive says all the time how far it is. `rooms` are those that it knows, beside
    what it has `learned`; where it is `lost` it cannot say where.
    """

    def __init__(
        self,
        *,
        arrives: bool = False,
        reports: bool = False,
        rooms: Sequence[str] = ROOMS,
        aliases: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.sent: list[Any] = []
        self.visited: list[Any] = []
        self.learned: tuple[str, ...] = ()
        self.rooms = OneOf(tuple(rooms), aliases, learned=lambda: self.learned)
        self.locked = False
        self.lost = False
        self.moving = False
        self.quick = arrives
        self.battery = 0.9
        self.on_halt: Callable[[], object] = lambda: None
        self._at = Pose2D(0.0, 0.0, 0.0)
        self._arrivals: float = 0
        self._reports = reports
        self._started = threading.Semaphore(0)
        self._changed = threading.Condition()

    def halt(self, reason: str) -> bool:
        self.on_halt()
        moved, self.moving = self.moving, False
        return moved

    def pose(self) -> Pose2D:
        """After a drive to the first room x is 1, to the second 2, and so on."""
        if self.lost:
            raise SkillFailed("I do not know where I am.")
        return self._at

    def start_over(self) -> None:
        """Stand where it stood when it was new."""
        self._at, self.sent[:], self.visited[:] = Pose2D(0.0, 0.0, 0.0), [], []

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
            self.quick, self._arrivals = False, 0

    def drive(self, goal: GoalHandle, where: Any, to_x_m: float | None = None) -> None:
        """Raises `Cancelled`, and `SkillFailed` where the door is locked."""
        if self.locked:
            raise SkillFailed("the door is locked")
        quick = self.quick
        with self._changed:
            self.moving = True
            self.sent.append(where)
            self._changed.notify_all()
        forget = goal.token.on_cancel(self._notify)
        self._started.release()
        self._wait_for_its_end(goal, lambda: quick or self._arrivals > 0 or goal.token.cancelled)
        forget()
        with self._changed:
            self.moving = False
            goal.token.check()
            self._arrivals -= not quick
            self.visited.append(where)
            if to_x_m is not None:
                self._at = Pose2D(to_x_m, 0.0, 0.0)

    def playing(self, skills: Iterable[Skill]) -> SkillSet:
        """Another robot's skills, with this body in the place of its own."""
        return SkillSet([replace(one, function=self._played(one), check=None) for one in skills])

    def skills(self, *names: str) -> SkillSet:
        """Those of its skills that have these names."""
        rooms = self.rooms

        @skill(
            templates=["[please] (go|drive) to [the] {room} [please]"],
            says="Going to the {room}.",
            done="I am in the {room}.",
            action="go to the {room}",
            undoable=True,
        )
        def navigate_to(goal: GoalHandle, room: Annotated[str, rooms]):
            """Drive to a room."""
            self.drive(goal, room, float(rooms.words.index(room) + 1))
            return {"room": room, "far": float("inf")}

        @skill(
            templates=["go to x {x} y {y}"], says="Going to x {x:g}, y {y:g}.", done="I am there."
        )
        def navigate_xy(goal: GoalHandle, x: float, y: float):
            """Drive to a point."""
            self.drive(goal, f"{x:g}, {y:g}", x)

        def walkable(distance: float) -> None:
            if distance > 9:
                raise SkillFailed(because("too_far"))

        @skill(
            templates=["walk {distance} (meters|metres)", "go ahead"],
            says="Walking {distance:g} metres.",
            done="I walked.",
            action="walk {distance:g} metres forward",
            check=walkable,
            relative=True,
            undoable=True,
        )
        def walk_forward(goal: GoalHandle, distance: Annotated[float, Field(ge=0.05, le=20)] = 1.0):
            """Walk forward."""
            self.drive(goal, distance, self._at.x_m + distance)

        @skill(templates=["take [the] {object}"], says="Taking the {object}.")
        def grasp(goal: GoalHandle, object: Annotated[str, OneOf(CUBES)]):  # noqa: A002
            """Take a cube."""
            self.drive(goal, object)

        @skill(templates=["put [the] {object} into [the] {target}"], says="Putting it away.")
        def place(
            goal: GoalHandle,
            object: Annotated[str, OneOf(CUBES)],  # noqa: A002
            target: Annotated[str, OneOf((*BINS, *CUBES))],
        ):
            """Put a cube somewhere."""
            self.drive(goal, (object, target))

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

        @skill(templates=["(stay there|(wait|stand) here|hold your position)"], says="Stopping.")
        def stop(goal: GoalHandle):
            """Stand."""

        own = (navigate_to, navigate_xy, walk_forward, grasp, place, dance, open_door)
        known = {one.name: one for one in (*own, get_pose, stop)}
        return SkillSet([known[name] for name in names])

    def _played(self, one: Skill) -> Callable[..., None]:
        def play(goal: GoalHandle, **arguments: Any) -> None:
            if one.drives:
                self.drive(goal, tuple(arguments.values()))

        return play

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()

    def _wait_for_its_end(self, goal: GoalHandle, over: Callable[[], bool]) -> None:
        while not over():
            if self._reports:
                goal.report(progress=PROGRESS)
            with self._changed:
                self._changed.wait_for(over, REPORT_S if self._reports else HUNG_S)
