"""The conversation: commands in, events out, on one thread; stopping never waits for it."""

import itertools
import logging
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from edgevox.agent.agents import Agent
from edgevox.agent.deeds import Deeds
from edgevox.agent.goals import Goal
from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.mind import Mind
from edgevox.agent.safety import SafetyWords
from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Interrupt, Reset, RunSkill, Speak, TextInput
from edgevox.core.events import (
    AgentEvent,
    AgentEventKind,
    State,
    StateChanged,
    Transcribed,
    TurnEnded,
)
from edgevox.core.text import MAX_CHARACTERS, clean

log = logging.getLogger(__name__)

MAX_WAITING = 64
"""How many utterances may wait. One more is refused, counted and logged; a stop never is."""


@dataclass(frozen=True, slots=True)
class _Announce:
    """Something to say that nobody asked for now: a goal ended, the robot stopped."""

    text: str


@dataclass(frozen=True, slots=True)
class _Forget:
    """Forget what was said, between turns."""


@dataclass(frozen=True, slots=True)
class _Settle:
    """Say that the conversation listens again, after a stop that cut no turn."""


@dataclass(frozen=True, slots=True)
class _Language:
    """Understand another language, between turns."""

    code: str


_Item = TextInput | Speak | RunSkill | _Announce | _Forget | _Settle | _Language
ConversationCommand = TextInput | Speak | Interrupt | Reset | RunSkill


class Conversation:
    """Owns the turns. `submit` may be called from any thread and never blocks.

    Stop words, `Interrupt` and `Reset` act on the calling thread, at once: they cancel the turn
    that runs, forget the utterances that wait, cancel the goals and halt the body. `halt` is the
    body's.
    """

    def __init__(
        self,
        agents: Sequence[Agent],
        bus: Bus,
        *,
        halt: Callable[[str], bool],
        model: LanguageModel | None = None,
        language: str = "en",
        clock: Clock | None = None,
    ) -> None:
        self._bus = bus
        self._clock = clock or SystemClock()
        every_skill = {name: s for agent in agents for name, s in agent.skills.items()}
        self._skills = SkillSet(every_skill.values())
        self._deeds = Deeds(bus, halt, announce=lambda text: self._put(_Announce(text)))
        self.mind = Mind(agents, bus, self._clock, model, language)
        self._safety = SafetyWords(language)
        self._numbers = itertools.count(1)
        self._items: deque[_Item] = deque()
        self._ready = threading.Condition()
        self._turn: Turn | None = None
        self._busy = False
        self._closed = False
        self._state: State | None = None
        self._state_gate = threading.RLock()
        self.refused = 0
        self._thread = threading.Thread(target=self._work, name="edgevox-conversation")

    def start(self) -> None:
        """Begin to listen."""
        self._deeds.start()
        self._set_state(State.LISTENING)
        self._thread.start()

    def close(self) -> None:
        """Stop everything and wait for the threads."""
        with self._ready:
            self._closed = True
            self._items.clear()
            self._ready.notify_all()
        self._deeds.stop("shutting down", self._turn)
        self._deeds.close()
        if self._thread.is_alive():
            self._thread.join()

    def submit(self, command: ConversationCommand) -> None:
        """Take a command."""
        match command:
            case Interrupt(reason=reason):
                self._stop(reason)
                self._put(_Settle())
            case Reset():
                self._stop("reset")
                self._put(_Forget())
            case TextInput(text=text) if word := self._safety.find(text):
                self._bus.publish(Transcribed(clean(text)))
                self._safety_stop(word)
            case _:
                self._put(command)

    def set_language(self, code: str) -> None:
        """Hear stop words of this language at once, and the rest from the next sentence on."""
        self._safety = SafetyWords(code)
        self._put(_Language(code))

    def check_goal(self, name: str, arguments: Mapping[str, Any]) -> None:
        """Raise what `start_goal` would raise; nothing happens."""
        self._deeds.check(Call(name, arguments), self._skills)

    def start_goal(
        self, name: str, arguments: Mapping[str, Any], goal_id: str | None = None
    ) -> Goal:
        """Run one skill for a program, without a turn: it is seen on the bus and never spoken of.

        Whatever moves pre-empts whatever moves, asked for in words or not, and stop words end it.
        A skill that moves nothing pre-empts nothing. Does not block; may be called from any
        thread. Raises `InvalidValue` (`UnknownSkill` for the name) or `SkillFailed` (too many
        wait), and then nothing has happened.
        """
        return self._deeds.begin(Call(name, arguments), self._skills, goal_id)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until nothing is said, thought or done any more; False after the timeout.

        For scripts and tests: the answer to a command and the end of the goals it started both
        count.
        """
        deadline_s = None if timeout_s is None else self._clock.now() + timeout_s
        while True:
            left_s = None if deadline_s is None else max(0.0, deadline_s - self._clock.now())
            with self._ready:
                if not self._ready.wait_for(lambda: not (self._items or self._busy), left_s):
                    return False
            if not self._deeds.busy and not self._items:
                return True
            if not self._deeds.wait_idle(left_s):
                return False

    def _put(self, item: _Item) -> None:
        with self._ready:
            full = (
                isinstance(item, TextInput | Speak | RunSkill) and len(self._items) >= MAX_WAITING
            )
            if not full and not self._closed:
                self._items.append(item)
                self._ready.notify_all()
        if full:
            self.refused += 1
            if self.refused.bit_count() == 1:  # 1, 2, 4, 8, ...: a flood leaves a few lines
                log.warning("%d utterances refused: %d are waiting", self.refused, MAX_WAITING)

    def _safety_stop(self, word: str) -> None:
        stopped = self._stop(f"heard {word!r}")
        data = {"word": word, "stopped": stopped}
        self._bus.publish(AgentEvent(AgentEventKind.SAFETY_PREEMPT, data))
        self._put(_Announce("Stopped." if stopped else "I am standing still."))

    def _stop(self, reason: str) -> bool:
        with self._ready:
            self._items.clear()
            turn = self._turn
        with self._state_gate:
            stopped = self._deeds.stop(reason, turn)
            if stopped:
                self._set_state(State.INTERRUPTED, turn)
        return stopped

    def _work(self) -> None:
        while True:
            with self._ready:
                self._ready.wait_for(lambda: self._items or self._closed)
                if self._closed:
                    return
                item = self._items.popleft()
                self._busy = True
                turn = self._turn = self._new_turn()
            try:
                self._handle(item, turn)
            except Exception:
                log.exception("a turn failed")
                turn.say("Something went wrong inside me. Please try again.")
            finally:
                self._end(turn, measured=isinstance(item, TextInput))

    def _handle(self, item: _Item, turn: Turn) -> None:
        match item:
            case TextInput(text=text):
                self._converse(text, turn)
            case Speak(text=text):
                turn.say(clean(text)[:MAX_CHARACTERS])
            case RunSkill(name=name, arguments=arguments):
                self._deeds.perform([Call(name, arguments)], self._skills, turn, "command")
            case _Announce(text=text):
                turn.say(text)
            case _Forget():
                self.mind.forget()
            case _Language(code=code):
                self.mind.set_language(code)
            case _Settle():
                pass

    def _converse(self, raw: str, turn: Turn) -> None:
        text = clean(raw)
        self._bus.publish(Transcribed(text[:MAX_CHARACTERS], turn.number))
        if not text:
            turn.say("I did not hear anything.")
        elif len(raw) > MAX_CHARACTERS:
            turn.say(f"That is too long: {len(raw)} characters, and I take {MAX_CHARACTERS}.")
        else:
            self._set_state(State.THINKING, turn)
            meaning = self.mind.understand(text, turn)
            if meaning and not turn.token.cancelled:
                self._deeds.perform(meaning.calls, meaning.agent.skills, turn, meaning.source)
            self.mind.remember(text, turn, meaning)

    def _new_turn(self) -> Turn:
        turn = Turn(
            next(self._numbers),
            self._bus,
            self._clock,
            on_speech=lambda: self._set_state(State.SPEAKING, turn),
        )
        return turn

    def _end(self, turn: Turn, *, measured: bool) -> None:
        turn.finish(measured=measured)
        with self._ready:
            self._turn = None
        self._set_state(State.LISTENING)
        self._bus.publish(TurnEnded(turn.number))
        with self._ready:
            self._busy = False
            self._ready.notify_all()

    def _set_state(self, state: State, turn: Turn | None = None) -> None:
        """Publish a change of state, in the order in which they happen; a cut turn has no say."""
        with self._state_gate:
            late = turn is not None and turn.token.cancelled and state is not State.INTERRUPTED
            if late or state is self._state:
                return
            self._state = state
            self._bus.publish(StateChanged(state, turn.number if turn else 0))
