"""What the conversation is doing, as a state machine with its transitions written down."""

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
"""From each state, where it can go. A turn thinks, then speaks; it never thinks again after that.
Whatever is cut goes through `interrupted`; what ends goes back to `listening`, or to `transcribing`
if somebody has spoken meanwhile."""

_IDLE = frozenset({State.LISTENING, State.INTERRUPTED})


class StateMachine:
    """Holds the state and publishes its changes, in the order in which they happen.

    `gate` is held while the state changes; hold it to do something together with a change. May be
    used from any thread.
    """

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._state = State.LISTENING
        self._unheard = 0
        self.gate = threading.RLock()

    @property
    def state(self) -> State:
        """What the conversation is doing."""
        return self._state

    @property
    def transcribes(self) -> bool:
        """Whether words are being found out, whatever else goes on."""
        return self._unheard > 0

    def start(self) -> None:
        """Say the first state."""
        self._bus.publish(StateChanged(self._state))

    def enter(self, state: State, turn: Turn | None = None) -> bool:
        """Go there for this turn, if the state can and the turn is not cut; whether it did."""
        with self.gate:
            late = turn is not None and turn.token.cancelled and state is not State.INTERRUPTED
            if late or state not in TRANSITIONS[self._state]:
                return False
            self._state = state
            self._bus.publish(StateChanged(state, turn.number if turn else 0))
            return True

    def rest(self) -> None:
        """Nothing is thought or said any more."""
        with self.gate:
            self.enter(State.TRANSCRIBING if self._unheard else State.LISTENING)

    def transcribing(self) -> None:
        """Somebody spoke, and the words are being found out."""
        with self.gate:
            self._unheard += 1
            if self._state in _IDLE:
                self.enter(State.TRANSCRIBING)

    def transcribed(self, *, words: bool) -> None:
        """The words are known; with none of them, the conversation listens again."""
        with self.gate:
            self._unheard = max(0, self._unheard - 1)
            if not words and self._state is State.TRANSCRIBING:
                self.rest()
