"""Runs goals beside the conversation: what moves, what waits in order, and what is answered."""

from collections.abc import Callable, Sequence

from edgevox.agent.goals import Goal
from edgevox.agent.lane import Lane, Plan
from edgevox.agent.reasons import because
from edgevox.core.deadlines import Deadlines
from edgevox.core.reason import Reason

MAX_BACKGROUND = 64
"""How many background goals may wait."""
ANSWER_S = 30.0
"""A skill that answers holds up what is said next, for so long at most."""


class GoalRunner:
    """Three lanes. What moves the body: the newest plan wins. Goals of programs that move nothing:
    in their order, each beside whatever moves or is said. What a turn asks: while it waits.

    `on_end` is called for every goal that moved, after its end was published.
    """

    def __init__(self, on_end: Callable[[Goal], None]) -> None:
        self._deadlines = Deadlines("edgevox-goals-deadlines")
        self._moving = Lane("moving", self._deadlines, on_end)
        self._background = Lane("background", self._deadlines)
        self._answering = Lane("answering", self._deadlines)
        self._lanes = (self._moving, self._background, self._answering)

    def start(self) -> None:
        self._deadlines.start()
        for lane in self._lanes:
            lane.start()

    def close(self) -> None:
        """Cancel everything and wait for the threads."""
        for lane in self._lanes:
            lane.close()
        self._deadlines.close()

    @property
    def busy(self) -> bool:
        """Whether any goal runs or waits."""
        return any(lane.busy for lane in self._lanes)

    @property
    def full(self) -> bool:
        """Whether one more background goal would be dropped."""
        return self._background.waiting >= MAX_BACKGROUND

    @property
    def moving(self) -> Goal | None:
        """The last of the goals that move or wait to."""
        return self._moving.last

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until nothing runs or waits; False if something still did after the timeout."""
        return all(lane.wait_idle(timeout_s) for lane in self._lanes)

    def move(self, goals: Sequence[Goal]) -> None:
        """Run these instead of whatever moves or waits to."""
        self._moving.replace(Plan(goals))

    def run_in_background(self, goal: Goal) -> None:
        """Run this after those that wait, without pre-empting anything."""
        if self.full:
            goal.accept()
            goal.drop(because("goals_wait", skill=goal.skill.name, count=str(MAX_BACKGROUND)))
        else:
            self._background.append(Plan((goal,)))

    def answer(self, goal: Goal) -> None:
        """Run this and block until it has ended, within `ANSWER_S`."""
        self._answering.append(Plan((goal,), ANSWER_S))
        goal.wait()

    def cancel_motion(self, reason: Reason | str) -> bool:
        """End what moves or waits to; True if anything did. Does not wait for its end."""
        return self._moving.cancel(reason)

    def cancel(self, reason: Reason | str) -> bool:
        """End everything; True if anything ran or waited. Does not wait for its end."""
        ended = [lane.cancel(reason) for lane in self._lanes]
        return any(ended)
