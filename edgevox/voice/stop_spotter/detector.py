"""The interface of a stop word detector, and the rule when a detected word counts.

The robot must not stop itself: it says "Stopped.", and reads "stop" from the list of its skills. So
while it is audible, a stop word counts only if it cannot be the robot's own, by either of two
signs: its current words do not sound like a stop word, or the microphone was louder than the echo
explains, for as long as a voice needs to interrupt it. Where the words or the loudness are unknown,
the robot stops.
"""

from collections import deque
from collections.abc import Callable
from typing import Protocol

from edgevox.core.languages import STOP_WORDS
from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.utterance_end import ONSET_FRAMES, VOICED

log = get_logger(__name__)

WORD_S = 0.7
"""A stop word, and how long the detector may need to be sure of it."""


class StopDetector(Protocol):
    """Looks at one frame after the other."""

    @property
    def word(self) -> str:
        """The stop word that it heard last."""

    @property
    def likelihood(self) -> float:
        """The likelihood of a stop word at the network's last look, 0 to 1."""

    def heard(
        self, samples: Samples, probability: float, language: str, *, playing: bool = False
    ) -> bool:
        """Return whether a stop word has just been said, once for each word.

        Args:
            samples: The next 512 samples, int16 at 16 kHz.
            probability: The probability that they hold a voice, 0 to 1.
            language: The ISO 639-1 code of the language that is spoken.
            playing: The robot itself may be audible, so any frame may hold a voice.
        """

    def forget(self) -> None:
        """The next frame does not follow on those before."""


class StopWatch:
    """Tells for each frame whether a person, and not the robot, has just said a stop word.

    `saying` is what the robot says now, or has just said. A detector's error costs one frame and is
    counted; hearing goes on.
    """

    def __init__(
        self, detector: StopDetector, *, saying: Callable[[], str], language: Callable[[], str]
    ) -> None:
        self._detector = detector
        self._saying = saying
        self._language = language
        self._loud: deque[bool] = deque(maxlen=round(WORD_S / FRAME_S))
        self.failed = 0

    @property
    def word(self) -> str:
        """The stop word that was said last."""
        return self._detector.word

    def heard(self, samples: Samples, probability: float, *, playing: bool, loud: bool) -> bool:
        """Take the next frame, as the microphone gave it, and how likely it holds any voice.

        `playing`: the robot or its echo may be audible; `loud`: it is louder than that explains, as
        all is while nothing plays: then it takes a voice. What the probability is of may have been
        cut out while it plays.
        """
        self._loud.append(loud and (playing or probability >= VOICED))
        return self._detected(samples, probability, playing) and not (playing and self._is_own())

    def forget(self) -> None:
        """The next frame does not follow on those before."""
        self._loud.clear()
        self._detector.forget()

    def _detected(self, samples: Samples, probability: float, playing: bool) -> bool:
        try:
            return self._detector.heard(samples, probability, self._language(), playing=playing)
        except Exception:
            self._detector.forget()
            self.failed += 1
            if worth_a_line(self.failed):
                log.exception("stop_spotter_failed", failed=self.failed)
            return False

    def _is_own(self) -> bool:
        return sum(self._loud) < ONSET_FRAMES and may_stop(self._saying(), self._language())


def may_stop(text: str, language: str) -> bool:
    """Return whether a listener may hear a stop word in this text, even as a part of a word."""
    said = text.casefold()
    tables = (STOP_WORDS[language], STOP_WORDS["en"])
    return any(word in said for table in tables for word in (*table.anywhere, *table.last))
