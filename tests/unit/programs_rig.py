"""A robot of two rooms that keeps programs, with all time in the test's hand."""

import itertools
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from fake_body import FakeBody
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.policy import Guard
from edgevox.agent.programs.senses import Senses
from edgevox.agent.skills import Call, OneOf, SkillSet, skill
from edgevox.core.agent_events import AgentEvent, ProgramChanged, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded, TurnEnded
from edgevox.core.interlock import Interlock
from edgevox.core.settings import Confirm
from edgevox.core.ways import Way

ROOMS = OneOf(("kitchen", "office", "bedroom", "dock"))


class HeldTime:
    """A clock and a timer that stand still until they are told."""

    def __init__(self) -> None:
        self._now_s = 1000.0
        self._numbers = itertools.count()
        self._set: list[tuple[float, int, Callable[[], None]]] = []
        self._lock = threading.Lock()

    def now(self) -> float:
        return self._now_s

    def start(self) -> None:
        """Nothing to start."""

    def close(self) -> None:
        self._set.clear()

    def set(self, seconds: float, action: Callable[[], None]) -> Callable[[], None]:
        with self._lock:
            entry = (self._now_s + seconds, next(self._numbers), action)
            self._set.append(entry)
        return lambda: self._set.remove(entry) if entry in self._set else None

    def advance(self, seconds: float) -> None:
        """Let time pass, and do what is due on the way."""
        end_s = self._now_s + seconds
        while due := [entry for entry in self._set if entry[0] <= end_s]:
            entry = min(due)
            self._set.remove(entry)
            self._now_s = max(self._now_s, entry[0])
            entry[2]()
        self._now_s = end_s


class Drives(FakeBody):
    """It drives to rooms, to places that it `learned` and to points, and has a battery."""

    def __init__(self) -> None:
        super().__init__()
        self.battery = 0.9
        self.learned: tuple[str, ...] = ()

    def known_skills(self) -> SkillSet:
        """What it can be asked for."""
        rooms = OneOf(ROOMS.fixed, learned=lambda: self.learned)

        @skill(
            templates=["[please] (go|drive) to [the] {room} [please]"],
            says="Going to the {room}.",
            done="I am in the {room}.",
        )
        def navigate_to(goal, room: Annotated[str, rooms]):
            """Drive to a room."""
            self.drive(goal, room)

        @skill(says="Going to x {x:g}, y {y:g}.", done="I am there.")
        def navigate_xy(goal, x: float, y: float):
            """Drive to a point."""
            self.drive(goal, f"{x:g}, {y:g}")

        @skill(templates=["(wait|stand) here"], says="Stopping.")
        def stop(goal):
            """Stop."""

        @skill(templates=["where are you"], done="I am here.", moves=False)
        def get_pose(goal):
            """Say where the robot is."""

        return SkillSet([navigate_to, navigate_xy, stop, get_pose])


class Talk:
    """A conversation with that robot, everything that was said, and what became of programs."""

    def __init__(
        self,
        language: str = "en",
        *,
        battery: bool = True,
        confirm: Confirm = "unsure",
        policy: Path | None = None,
    ) -> None:
        self.bus, self.body, self.time, self.interlock = Bus(), Drives(), HeldTime(), Interlock()
        self.said: list[str] = []
        self.events: list[dict[str, Any]] = []
        self._turned = threading.Condition()
        self._turns = 0
        self.bus.subscribe(Responded, lambda event: self.said.append(event.text))
        self.bus.subscribe(AgentEvent, lambda event: self.events.append(as_json(event)))
        self.bus.subscribe(ProgramChanged, lambda _: self._note())
        self.bus.subscribe(TurnEnded, lambda _: self._note())
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", self.body.known_skills())],
            self.bus,
            halt=self.body.halt,
            language=language,
            confirm=confirm,
            guard=Guard(policy, self.bus),
            clock=self.time,
            interlock=self.interlock,
            timer=self.time,
            senses=Senses(
                battery=(lambda: self.body.battery) if battery else None,
                way_back=lambda: Call("navigate_xy", {"x": 1.0, "y": 2.0}),
            ),
        )
        self.conversation.start()

    def say(self, text: str, way: Way = Way.TEXT_INPUT) -> str:
        """Say it; the first that is answered."""
        before = len(self.said)
        self.conversation.submit(TextInput(text, way))
        self.until(lambda: len(self.said) > before)
        return self.said[before]

    def until(self, true: Callable[[], object]) -> None:
        """Wait for what threads do."""
        with self._turned:
            assert self._turned.wait_for(true, HUNG_S), (self.said, self.statuses())

    def until_said(self, text: str) -> None:
        self.until(lambda: text in self.said)

    def programs(self) -> list[dict[str, Any]]:
        """What was told of programs."""
        return [event for event in self.events if event["kind"] == "program"]

    def statuses(self) -> list[str]:
        return [event["status"] for event in self.programs()]

    def ended(self) -> None:
        """Wait until no program is kept, and nothing moves."""
        self.until(lambda: not self.conversation.programs.kept)
        assert self.conversation.wait_idle(HUNG_S)

    def _note(self) -> None:
        with self._turned:
            self._turned.notify_all()
