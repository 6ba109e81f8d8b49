"""Where a scenario plays in this process: a conversation and a body, and what is seen of them."""

import queue
import threading
from collections.abc import Mapping
from typing import Any

from edgevox.agent.conversation import Conversation
from edgevox.agent.policy import Guard
from edgevox.core.agent_events import AgentEvent, GoalChanged, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded, Transcribed, TurnEnded
from edgevox.robots.capabilities import Advances, Body, TakesVelocity, TellsMotions, Twist2D
from edgevox.scenario.scenario_judge import Seen, Source

SETTLE_S = 0.02
"""After a stimulus, no time passes for the robot until all has been quiet this long."""
MOST_SETTLE_S = 1.0
MOST_THINK_S = 10.0
"""So long no time passes for the robot while a goal runs that does not move it, or not yet."""
_LOOK_AGAIN_S = 0.001
CATCH_UP_S = 0.0005
"""How long the other threads may take to follow what a moment of the robot's time brought."""


class ConversationHarness:
    """Gives stimuli and collects what is seen, until `close`.

    A body whose simulated time is in lockstep does not move while the agent thinks. Any other runs
    in real time.
    """

    def __init__(
        self, bus: Bus, conversation: Conversation, body: Body, guard: Guard | None = None
    ) -> None:
        self._conversation, self._body = conversation, body
        self._guard = guard or Guard()
        self._seen: queue.SimpleQueue[Seen] = queue.SimpleQueue()
        self._turns = threading.Condition()
        self._turn = 0
        self._thought = False
        self._patience_s = MOST_THINK_S
        self._goal_changed = threading.Event()
        self._forget = [
            bus.subscribe(Responded, lambda event: self._note(Source.ANSWER, event.written)),
            bus.subscribe(AgentEvent, self._on_agent_event),
            bus.subscribe(Transcribed, self._on_words),
            bus.subscribe(TurnEnded, self._on_turn_end),
        ]

    def close(self) -> None:
        """Collect nothing more."""
        for forget in self._forget:
            forget()

    @property
    def time_s(self) -> float:
        """The robot's time."""
        return self._body.time_s

    def say(self, text: str, timeout_s: float) -> None:
        """Say it, and wait until it is answered or the timeout is over; goals may still run."""
        self._submit(TextInput(text), timeout_s)

    def interrupt(self, timeout_s: float) -> None:
        """Stop everything."""
        self._submit(Interrupt("scenario"), timeout_s)

    def run(self, skill: str, arguments: Mapping[str, Any]) -> None:
        """Start a skill. Raises `EdgeVoxError` if it is refused."""
        self._conversation.start_goal(skill, arguments)
        self._settle()

    def steer(self, linear_m_s: float, angular_rad_s: float) -> None:
        """One velocity of a stream. Raises `InvalidValue` for a body that takes none, and `Denied`
        where the policy refuses it.
        """
        if not isinstance(self._body, TakesVelocity):
            raise InvalidValue("drive", self._body.name, "a robot that takes velocities")
        self._body.set_velocity(Twist2D(*self._guard.velocity(linear_m_s, angular_rad_s)))

    def let_pass(self, seconds: float) -> list[Seen]:
        """Let time pass; what was seen in it, and the state at its end."""
        if isinstance(self._body, Advances):
            self._body.advance(seconds)
            self._let_goals_think()
            return self.look(CATCH_UP_S)
        return self.look(seconds)

    def look(self, wait_s: float = 0.0) -> list[Seen]:
        """What was seen since the last time, and the state now; waits a little for the first."""
        found: list[Seen] = []
        try:
            found.append(self._seen.get(timeout=wait_s) if wait_s else self._seen.get_nowait())
            while True:
                found.append(self._seen.get_nowait())
        except queue.Empty:
            return [*found, Seen(self.time_s, Source.STATE, self._body.state())]

    def come_to_rest(self, seconds: float) -> None:
        """Stop everything and let time pass until nothing runs any more, at most this much."""
        self._conversation.submit(Interrupt("the scenario is over"))
        passed_s = 0.0
        while passed_s < seconds and not self._conversation.wait_idle(0.01):
            self.let_pass(0.1)
            passed_s += 0.1

    def _submit(self, command: TextInput | Interrupt, timeout_s: float) -> None:
        with self._turns:
            self._turn, self._thought = 0, False
        self._conversation.submit(command)
        with self._turns:
            self._turns.wait_for(lambda: self._thought, timeout_s)
        self._settle()

    def _settle(self) -> None:
        """Wait until no other thread has anything more to tell."""
        self._let_goals_think()
        pause, waited_s, before = threading.Event(), 0.0, -1
        while self._seen.qsize() != before and waited_s < MOST_SETTLE_S:
            before = self._seen.qsize()
            pause.wait(SETTLE_S)
            waited_s += SETTLE_S

    def _let_goals_think(self) -> None:
        """Wait until every goal has ended, or the robot is in motion for one.

        A goal's thread may be slow to begin, and to go on where a motion ended.
        """
        if not isinstance(self._body, TellsMotions):
            return
        while not self._body.in_motion:
            if self._goal_changed.is_set():
                self._goal_changed.clear()
                self._patience_s = MOST_THINK_S
            if self._patience_s <= 0.0 or self._conversation.wait_idle(_LOOK_AGAIN_S):
                return
            self._patience_s -= _LOOK_AGAIN_S

    def _note(self, source: Source, data: Any) -> None:
        self._seen.put(Seen(self.time_s, source, data))

    def _on_agent_event(self, event: AgentEvent) -> None:
        if isinstance(event, GoalChanged) and event.feedback is None:
            self._goal_changed.set()
        self._note(Source.EVENT, as_json(event))

    def _on_words(self, event: Transcribed) -> None:
        with self._turns:
            self._turn = event.turn

    def _on_turn_end(self, event: TurnEnded) -> None:
        """The turn of these words is over; those that stop the robot have none of their own."""
        with self._turns:
            if self._turn in (0, event.turn):
                self._thought = True
                self._turns.notify_all()
