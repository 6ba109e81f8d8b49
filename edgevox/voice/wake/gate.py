"""The wake gate: decides which speech is for the robot, a state machine over times.

Without the wake word no speech is acted on, with two exceptions. A robot that is told to stop must
stop, so a short utterance without the wake word is transcribed too. And nobody says the wake word
to answer a question or to go on: while a follow-up is awaited, a longer utterance is transcribed,
and its words tell whether it is one.
"""

from enum import Enum, auto

from edgevox.voice.utterance_end import SpeechEnded, SpeechPaused

FOLLOW_S = 8.0
"""Seconds after the wake word in which speech is for the robot."""
SHORT_S = 2.5
"""An utterance without the wake word that is longer is not looked into."""
FOLLOW_UP_S = 8.0
"""The same while a follow-up is awaited."""
PHRASE_ALONE_S = 0.4
"""Less speech than this after the wake word is its own end."""
PHRASE_S = 1.3
"""Seconds before its detection within which the wake word is said."""


class WakeDecision(Enum):
    """A decision on an utterance."""

    TAKE = auto()
    UNADDRESSED = auto()
    """Its words tell whether it is for the robot: a stop word, or a follow-up."""
    IGNORE = auto()


class WakeGate:
    """Tells for each utterance whether it is meant for the robot."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """The wake word counts no longer."""
        self._woken_s: float | None = None
        self._until_s = 0.0
        self._taken: tuple[float, float | None] | None = None

    def wake(self, now_s: float) -> None:
        """The wake word was heard; it ended about now."""
        self._woken_s = now_s
        self._until_s = now_s + FOLLOW_S

    def has(self, now_s: float) -> bool:
        """Return whether speech at this time is for the robot."""
        return self._woken_s is not None and now_s <= self._until_s

    def judge(self, speech: SpeechEnded | SpeechPaused, *, awaited: bool = False) -> WakeDecision:
        """Decide on the utterance, as if it were over; `awaited` if it may be a follow-up."""
        woken_s = self.woken_for(speech)
        if woken_s is not None:
            alone = woken_s >= speech.began_s and speech.ended_s - woken_s < PHRASE_ALONE_S
            # After the phrase alone, what is meant comes next.
            return WakeDecision.IGNORE if alone else WakeDecision.TAKE
        if speech.ended_s - speech.began_s <= (FOLLOW_UP_S if awaited else SHORT_S):
            return WakeDecision.UNADDRESSED
        return WakeDecision.IGNORE

    def take(self, speech: SpeechEnded) -> None:
        """Use the wake word up: later speech needs another one, unless this utterance goes on."""
        taken = speech.began_s, self.woken_for(speech)
        self.reset()
        self._taken = taken

    def phrase_from(self, speech: SpeechEnded | SpeechPaused) -> float | None:
        """Seconds into the utterance at which the wake word may begin; None if it is not in it."""
        woken_s = self.woken_for(speech)
        if woken_s is None or not speech.began_s <= woken_s <= speech.ended_s + 0.2:
            return None
        return max(0.0, woken_s - PHRASE_S - speech.began_s)

    def woken_for(self, speech: SpeechEnded | SpeechPaused) -> float | None:
        """Return when the wake word was heard that this speech follows; None without one."""
        if self._taken and self._taken[0] == speech.began_s:
            return self._taken[1]
        return self._woken_s if self.has(speech.began_s) else None
