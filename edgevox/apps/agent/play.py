"""The player that runs a scenario file with a whole agent and reports the result."""

import queue
import threading
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from edgevox.agent.conversation import Conversation
from edgevox.agent.policy import Guard
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.streams import show
from edgevox.core.agent_events import AgentEvent, GoalChanged, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded, Transcribed, TurnEnded
from edgevox.core.settings import NO_LLM, Settings
from edgevox.robots.capabilities import Advances, Body, TakesVelocity, TellsMotions, Twist2D
from edgevox.robots.pictures import check_picture, write_picture
from edgevox.scenario import Scenario, load_scenario, run_scenario
from edgevox.scenario.judge import Seen, Source
from edgevox.scenario.run import StepResult, heading, line, summary

SETTLE_S = 0.02
"""After a stimulus, no time passes for the robot until all has been quiet this long."""
MOST_SETTLE_S = 1.0
MOST_THINK_S = 10.0
"""Seconds for which the robot's time waits while a goal runs that does not move it, or not yet."""
_LOOK_AGAIN_S = 0.001
CATCH_UP_S = 0.0005
"""Seconds in which the other threads follow a moment of the robot's time."""


class ConversationHarness:
    """Gives stimuli and collects the reactions, until `close`.

    A body whose simulated time is in lockstep does not move while the agent thinks. Any other body
    runs in real time.
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
        """Send one velocity of a stream.

        Raises `InvalidValue` for a body without velocities, and `Denied` if the policy refuses it.
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
        """Return the events since the last call, and the state now.

        Waits a little for the first.
        """
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


REST_S = 30.0
"""Seconds of the robot's time in which it may come to rest at the end."""


@dataclass(frozen=True)
class Script:
    """A scenario and the file it is from."""

    file: Path
    scenario: Scenario

    def flags(self, given: dict[str, Any]) -> dict[str, Any]:
        """Return the settings to load: given ones overrule the scenario.

        In text, no model unless named.
        """
        own = dict(self.scenario.settings)
        for name in ("world", "mjcf", "locations", "policy"):
            if name in own:
                own[name] = str(self.file.parent / str(own[name]))
        return {"llm": NO_LLM, "text_mode": True, **own, **given}


def read_script(file: Path, robot: str) -> Script:
    """Read the file. Raises `InvalidValue` for what is wrong in it, or for another robot."""
    scenario = load_scenario(file)
    if scenario.agent and robot not in scenario.agent:
        raise InvalidValue(f"{file.name}: agent", robot, "one of " + ", ".join(scenario.agent))
    return Script(file, scenario)


def play(
    script: Script,
    settings: Settings,
    body: Body,
    *,
    snapshot: Path | None = None,
    ros_args: Sequence[str] = (),
) -> bool:
    """Play it from start to end, with the report on stdout; whether all came true."""
    shown = check_picture(body, snapshot) if snapshot else None
    last: list[StepResult] = []

    def tell(outcome: StepResult) -> None:
        last[:] = [outcome]
        _write(line(outcome))

    with ExitStack() as stack:
        parts = build_parts(stack, settings, body)
        harness = ConversationHarness(parts.bus, parts.conversation, body, parts.guard)
        stack.callback(harness.close)
        start_parts(stack, parts, ros_args)
        _write(heading(script.scenario, script.file.name, body.name))
        stack.callback(harness.come_to_rest, REST_S)
        passed = run_scenario(script.scenario, harness, tell)
        if shown and snapshot:
            write_picture(shown, snapshot)
    _write(summary(script.scenario, last[0] if last else None))
    return passed


def _write(text: str) -> None:
    show(text)
