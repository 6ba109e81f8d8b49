"""A conversation with a body whose drives end when the test says, and a held clock."""

import threading
from typing import Annotated

from clocks import HeldClock
from pydantic import Field

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.grammar import DO, END
from edgevox.agent.skills import OneOf, SkillSet, skill
from edgevox.core.agent_events import GoalChanged, GoalStatus, ToolCalled
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded
from edgevox.core.transforms import Pose2D

HUNG_S = 60.0


class Walker:
    """A body that is in a place or steps forward at once, unless it is told to take its time."""

    def __init__(self, rooms=("kitchen", "office"), learned=tuple):
        self.at, self.moves = Pose2D(0.0, 0.0, 0.0), []
        self.slow, self.started, self.arrived = False, threading.Event(), threading.Event()
        rooms, cubes = OneOf(rooms, {}, learned), OneOf(("red_cube", "green_cube", "blue_cube"))
        bins = OneOf(("left_bin", "right_bin", "red_cube", "green_cube", "blue_cube"))

        @skill(templates=["go to [the] {room}"], says="Going to the {room}.", done="There.")
        def navigate_to(goal, room: Annotated[str, rooms]):
            """Drive to a room."""
            self._move(goal, room, float(rooms.words.index(room) + 1))

        @skill(templates=["go to x {x} y {y}"], says="Going to x {x:g}, y {y:g}.")
        def navigate_xy(goal, x: float, y: float):
            """Drive to a point."""
            self._move(goal, (x, y), x)

        @skill(templates=["walk {distance} metres"], says="Walking.", relative=True)
        def walk_forward(goal, distance: Annotated[float, Field(ge=0.05, le=20)] = 1.0):
            """Walk ahead."""
            self._move(goal, distance, self.at.x_m + distance)

        @skill(templates=["take [the] {object}"], says="Taking the {object}.")
        def grasp(goal, object: Annotated[str, cubes]):  # noqa: A002
            """Take a cube."""
            self._move(goal, object, self.at.x_m)

        @skill(templates=["put [the] {object} into [the] {target}"], says="Putting it away.")
        def place(goal, object: Annotated[str, cubes], target: Annotated[str, bins]):  # noqa: A002
            """Put a cube somewhere."""
            self._move(goal, (object, target), self.at.x_m)

        @skill(templates=["where are you"], done="I am here.", moves=False)
        def get_pose(goal):
            """Say where it is."""

        self.skills = SkillSet([navigate_to, navigate_xy, walk_forward, grasp, place, get_pose])

    def pose(self):
        return self.at

    def halt(self, reason):
        return False

    def _move(self, goal, what, x_m):
        self.moves.append(what)
        self.arrived = threading.Event()
        self.started.set()
        if self.slow:
            arrived = self.arrived
            goal.report(progress=0.42)
            forget = goal.token.on_cancel(arrived.set)
            assert arrived.wait(HUNG_S)
            forget()
        if goal.token.cancelled:
            raise Cancelled(goal.token.reason)
        self.at = Pose2D(x_m, 0.0, 0.0)


class Model:
    """Says the same calls to everything."""

    name, context_tokens = "model", 4096

    def __init__(self, calls):
        self.calls = calls

    def generate(self, messages, *, grammar, max_tokens, token):
        yield f"{DO}{self.calls};{END}"

    def prime(self, messages, token):
        """Nothing to read."""

    def count_tokens(self, text):
        return len(text.split())

    def close(self):
        """Nothing to free."""


class Rig:
    """Talks, and keeps what was answered and called."""

    def __init__(self, body=None, *, model=None, language="en", confirm="unsure", **more):
        self.body, self.bus, self.clock = body or Walker(), Bus(), HeldClock(1000.0)
        self.answers, self.calls, self.changes = [], [], []
        self.bus.subscribe(Responded, self.answers.append)
        self.bus.subscribe(ToolCalled, self.calls.append)
        self.bus.subscribe(GoalChanged, self.changes.append)
        self.talk = Conversation(
            [Agent("robot", "Be brief.", self.body.skills)],
            self.bus,
            halt=self.body.halt,
            model=model,
            language=language,
            confirm=confirm,
            clock=self.clock,
            pose=self.body.pose,
            **more,
        )
        self.talk.start()

    def say(self, text):
        """The first answer to this, once everything has ended."""
        return self.hear(text).text

    def hear(self, text):
        """The same with what is only written."""
        before = len(self.answers)
        self.talk.submit(TextInput(text))
        assert self.talk.wait_idle(HUNG_S)
        return self.answers[before]

    def ask(self, text):
        """The answer to this while the body moves."""
        answered = threading.Event()
        before = len(self.answers)
        forget = self.bus.subscribe(Responded, lambda _: answered.set())
        self.talk.submit(TextInput(text))
        assert answered.wait(HUNG_S)
        forget()
        return self.answers[before].text

    def begin(self, text):
        """Say this and wait until the body has begun; it goes on until `arrive`."""
        self.body.slow = True
        self.body.started.clear()
        told = threading.Event()

        def heard(event):
            if event.feedback is not None:
                told.set()

        forget = self.bus.subscribe(GoalChanged, heard)
        acknowledged = self.ask(text)
        assert told.wait(HUNG_S)
        forget()
        return acknowledged

    def arrive(self):
        """Let the body come to the end of what it does."""
        self.body.slow = False
        self.body.arrived.set()
        assert self.talk.wait_idle(HUNG_S)

    def ended(self, skill):
        """How the goals of this skill ended, of those that were not cancelled."""
        ends = (GoalStatus.SUCCEEDED, GoalStatus.FAILED)
        return [one.status for one in self.changes if one.skill == skill and one.status in ends]
