"""How likely Whisper finds it that a stop word was just said, where the spotter thinks of one.

The spotter's network looks at a second and knows three words; in noise, "Never step back" may be
one to it. Whisper looks at more and knows all words. It makes a few hypotheses of the last seconds,
as `whisper` does of an utterance, but is told of no commands: those it would hear everywhere.
"""

import math
import re
from pathlib import Path

from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.whisper import Whisper

LOOKED_AT = int(2.6 * RATE_HZ)
"""Samples: a stop word and what was said before it."""
_STOP_WORD = re.compile(r"\b(stop|stops|stopped|halt|freeze|frees)\b", re.IGNORECASE)


class SecondLook:
    """Whisper's smallest English model, from its folder, loaded when it is first asked.

    It is not the one that transcribes: who says "stop" does not wait for what was said before. It
    may be asked from any thread.
    """

    def __init__(self, folder: Path) -> None:
        self._whisper = Whisper(lambda _: folder, threads=1)

    def likelihood(self, sound: Samples) -> float:
        """Of all that may have been said in the last `LOOKED_AT` samples, what of the likelihood
        has a stop word, 0 to 1; mostly little, as much may be said. Takes some 45 ms of a core.

        Raises `EdgeVoxError` where the model cannot be loaded.
        """
        found = self._whisper.hypotheses(sound, "en")
        return sum(math.exp(one.whole) for one in found if _STOP_WORD.search(one.text))
