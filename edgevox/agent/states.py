"""The conversation's state machine, with its transitions written down."""

import threading
from collections.abc import Mapping

from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.events import State, StateChanged

TRANSITIONS: Mapping[State, frozenset[State]] = {
    State.LISTENING: frozenset(
        {State.TRANSCRIBING, State.THINKING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.TRANSCRIBING: frozenset(
        {State.LISTENING, State.THINKING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.THINKING: frozenset(
        {State.LISTENING, State.TRANSCRIBING, State.SPEAKING, State.INTERRUPTED}
    ),
    State.SPEAKING: frozenset({State.LISTENING, State.TRANSCRIBING, State.INTERRUPTED}),
    State.INTERRUPTED: frozenset(
        {State.LISTENING, State.TRANSCRIBING, State.THINKING, State.SPEAKING}
    ),
}
"""The states that may follow each state. A turn thinks, then speaks, and never thinks again after
that. A turn that is cut goes through `interrupted`; a turn that ends goes back to `listening`, or
to `transcribing` if a person has spoken meanwhile."""

_IDLE = frozenset({State.LISTENING, State.INTERRUPTED})


class StateMachine:
    """Holds the state and publishes its changes, in their order. Any thread may use it."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._state = State.LISTENING
        self._unheard = 0
        self.gate = threading.RLock()
        """Held while the state changes; hold it to do something together with a change."""

    @property
    def state(self) -> State:
        """The state now."""
        return self._state

    @property
    def transcribes(self) -> bool:
        """True while an utterance is being transcribed, in any state."""
        return self._unheard > 0

    def start(self) -> None:
        """Publish the first state."""
        self._bus.publish(StateChanged(self._state))

    def enter(self, state: State, turn: Turn | None = None) -> bool:
        """Enter `state` if the transition exists and the turn is not cut; return whether it did."""
        with self.gate:
            late = turn is not None and turn.token.cancelled and state is not State.INTERRUPTED
            if late or state not in TRANSITIONS[self._state]:
                return False
            self._state = state
            self._bus.publish(StateChanged(state, turn.number if turn else 0))
            return True

    def rest(self) -> None:
        """Return to `listening`, or to `transcribing` while an utterance is transcribed."""
        with self.gate:
            self.enter(State.TRANSCRIBING if self._unheard else State.LISTENING)

    def transcribing(self) -> None:
        """Count an utterance whose transcription has begun."""
        with self.gate:
            self._unheard += 1
            if self._state in _IDLE:
                self.enter(State.TRANSCRIBING)

    def transcribed(self, *, words: bool) -> None:
        """Count off a transcribed utterance; without `words` the conversation listens again."""
        with self.gate:
            self._unheard = max(0, self._unheard - 1)
            if not words and self._state is State.TRANSCRIBING:
                self.rest()
