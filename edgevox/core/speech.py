"""Speaking aloud, as the conversation sees it: what is to be said, and what became of it.

What words tell of whether somebody who fell silent has ended.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from edgevox.core.cancel import CancelToken


class Ending(StrEnum):
    """How what was said so far ends.

    `FINAL`: nothing that follows could change it, a stop. `WHOLE`: a plain command. `MAY_GO_ON`: a
    plain command that often has more words, as "turn left". `OPEN`: anything else. `BROKEN_OFF`: it
    ends in a word that more must follow, as "go to the".
    """

    FINAL = "final"
    WHOLE = "whole"
    MAY_GO_ON = "may_go_on"
    OPEN = "open"
    BROKEN_OFF = "broken_off"


@dataclass(frozen=True, slots=True)
class Spoken:
    """What became of an utterance.

    `text` is what was audible: whole sentences, and of the one that was cut the words up to the
    cut. `first_audible_s` is the clock's time of the first sample, None if nothing was played.
    `synthesis_s` is how long the synthesiser worked for all of it.
    """

    text: str
    cut: bool = False
    first_audible_s: float | None = None
    synthesis_s: float = 0.0


class Utterance(Protocol):
    """One answer on its way to the loudspeaker."""

    def say(self, sentence: str) -> None:
        """One more sentence; does not block."""

    def finish(self) -> Spoken:
        """There are no more: block until all is audible, or the token is cancelled."""


class TextToSpeech(Protocol):
    """Speaks one utterance at a time."""

    def begin(self, token: CancelToken, on_audible: Callable[[], object]) -> Utterance:
        """A new utterance. A cancelled token silences it within 0.1 s; nothing more of it is said.

        `on_audible` is called once, on the playback thread, when its first sample is played.
        """
