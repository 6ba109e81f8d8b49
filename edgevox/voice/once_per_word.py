"""One word is heard once, though a network finds it in every window that holds it."""

from edgevox.voice.audio import FRAME_S


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
