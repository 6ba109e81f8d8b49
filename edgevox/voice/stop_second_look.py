"""Whether Whisper hears a stop word in what was just said, of which the spotter is not sure.

The spotter's network looks at a second and knows three words; in noise, "Never step back" may be
one to it. Whisper looks at more and knows all words. It makes a few hypotheses of the last seconds,
as `whisper` does of an utterance, but is told of no commands: those it would hear everywhere.
"""

import re
from pathlib import Path

import numpy as np

from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.whisper import Whisper

LOOKED_AT = int(2.6 * RATE_HZ)
"""Samples: a stop word and what was said before it."""
SHARE = 0.6
"""Of the likelihood of all hypotheses, what those with a stop word must have. By it and the others
it is chosen how much is heard, and how often it stops for nothing: see docs/stop-spotter.md."""
_STOP_WORD = re.compile(r"\b(stop|stops|stopped|halt|freeze|frees)\b", re.IGNORECASE)


class SecondLook:
    """Whisper's smallest English model, from its folder, loaded when it is first asked.

    It is not the one that transcribes: who says "stop" does not wait for what was said before. It
    may be asked from any thread.
    """

    def __init__(self, folder: Path) -> None:
        self._whisper = Whisper(lambda _: folder, threads=1)

    def has_stop_word(self, sound: Samples) -> bool:
        """Whether there is one in the last `LOOKED_AT` samples. Takes some 45 ms of a core.

        Raises `EdgeVoxError` where the model cannot be loaded.
        """
        found = self._whisper.hypotheses(sound, "en")
        weights = np.exp([one.whole for one in found])
        with_one = [bool(_STOP_WORD.search(one.text)) for one in found]
        return float(weights[with_one].sum()) >= SHARE * float(weights.sum()) > 0
