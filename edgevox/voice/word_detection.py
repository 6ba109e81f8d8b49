"""One word is heard once, though a network finds it in every window that holds it.

Lets networks sleep while nobody speaks, and hear what they slept through.

What was heard in the two seconds before, as much as they look at, is kept and given to them as soon
as there may be a voice, so they hear a phrase as if they had been awake. They run on for a moment
after it.
"""

from collections import deque
from collections.abc import Sequence

from edgevox.voice.audio import FRAME_S, Samples

AWAKE = 0.1
"""From this probability of a voice on, the networks are awake."""
AWAKE_S = 1.0
"""They stay awake for so long after the last frame that may hold a voice."""
KEPT_S = 2.0
"""So much of what was heard before they woke is given to them."""


class WakeSleep:
    """Says which frames the networks are to hear now."""

    def __init__(self, *, always_awake: bool = False) -> None:
        self._always_awake = always_awake
        self._before: deque[Samples] = deque(maxlen=round(KEPT_S / FRAME_S))
        self._awake = 0  # frames left

    def push(self, samples: Samples, probability: float) -> Sequence[Samples]:
        """Take the next frame, with its probability of voice; none while they sleep."""
        if probability >= AWAKE or self._always_awake:
            self._awake = round(AWAKE_S / FRAME_S)
        if not self._awake:
            self._before.append(samples)
            return ()
        self._awake -= 1
        heard = [*self._before, samples]
        self._before.clear()
        return heard

    def reset(self) -> None:
        """Forget what was heard, and sleep."""
        self._before.clear()
        self._awake = 0


class OncePerWord:
    """After a word that counts none does for `rest_s`. Told every frame."""

    def __init__(self, rest_s: float) -> None:
        self._rest_frames = round(rest_s / FRAME_S)
        self._left = 0

    @property
    def resting(self) -> bool:
        """Whether none would count in the next frame."""
        return self._left > 0

    def counts(self, found: bool) -> bool:
        """Take the next frame; whether the word that was `found` in it is a new one."""
        if self._left:
            self._left -= 1
            return False
        if found:
            self._left = self._rest_frames
        return found

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._left = 0
