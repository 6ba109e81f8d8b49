"""Speech, as the conversation sees it: protocols for speaking aloud, and endings of utterances."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from edgevox.core.cancel import CancelToken
from edgevox.core.commands import Heard


class Ending(StrEnum):
    """Endings of the words so far, to tell whether a person who fell silent has finished."""

    FINAL = "final"
    """A stop: no further word could change it."""
    WHOLE = "whole"
    """A plain command."""
    MAY_GO_ON = "may_go_on"
    """A plain command that often has more words: "turn left"."""
    OPEN = "open"
    """Any other words."""
    BROKEN_OFF = "broken_off"
    """Words whose last one needs another: "go to the"."""


@dataclass(frozen=True, slots=True)
class Spoken:
    """The result of a spoken utterance."""

    text: str
    """The audible part: whole sentences, and of a cut one the words up to the cut."""
    cut: bool = False
    """True if it was cut before its end."""
    first_audible_s: float | None = None
    """The clock's time of the first sample; None if nothing was played."""
    synthesis_s: float = 0.0
    """Seconds that the synthesiser worked for all of it."""


class Utterance(Protocol):
    """An answer on its way to the loudspeaker."""

    def say(self, sentence: str) -> None:
        """Add a sentence; does not block."""

    def finish(self) -> Spoken:
        """Tell that no sentence follows; block until all was audible or the token is cancelled."""


class TextToSpeech(Protocol):
    """Speaks one utterance at a time."""

    def begin(self, token: CancelToken, on_audible: Callable[[], object]) -> Utterance:
        """Begin an utterance. A cancelled token silences it for good, within 0.1 s.

        `on_audible` is called once, on the playback thread, when its first sample is played.
        """

    def hold(self) -> None:
        """Fall silent within 0.1 s, for 5 s or until `release`, if an utterance plays. Any thread.

        The next utterance is not held.
        """

    def release(self) -> None:
        """Speak on, from a pause shortly before the point where it was held. Any thread."""


class FollowUp(Protocol):
    """Tells which words are for the robot although they have no wake word. Any thread may ask."""

    def begins(self) -> None:
        """Take note that somebody begins to speak, perhaps to the robot."""

    def awaits(self, began_s: float, ended_s: float) -> bool:
        """True if words with these times, of the clock, may answer or follow what the robot said.

        It is asked before their transcript exists.
        """

    def asked(self, ended_s: float) -> bool:
        """True if words that end then may answer a question of the robot."""

    def takes(self, heard: Heard) -> bool:
        """True if these words do so."""
