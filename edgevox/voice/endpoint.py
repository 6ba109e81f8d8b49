"""Where speech begins and where it ends: a state machine over frames, nothing else."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from edgevox.core.speech import Ending
from edgevox.voice.audio import FRAME_S, Frame, Samples

VOICED = 0.5
"""From this probability on a frame is voiced."""
UNVOICED = 0.35
"""Below it a frame of speech is a pause; in between, it goes on as it was."""
ONSET_FRAMES = 5
"""So many voiced frames (0.16 s) begin speech: a click or a cough is shorter, "no" is longer."""
ONSET_WINDOW = 7
"""They must lie within so many frames."""
PRE_ROLL_S = 0.3
"""Heard before the first voiced frame: consonants are quiet."""
SURMISED_S = 0.8
"""So much before it may be spoken already, where that is not known at once."""
SURMISED_GAP = 3
"""So many frames of it may hold no voice."""
END_S = 0.6
"""So much silence ends an utterance: people pause for less within a sentence."""
GOES_ON_S = 1.0
"""Who speaks again within so long after what was ended by its words speaks on: few pause for longer
than 0.8 s within a sentence, and what ends or begins softly is no voice for 0.1 s more."""
ENDS_AFTER_S: Mapping[Ending, float] = {
    Ending.FINAL: 0.0,
    Ending.WHOLE: 0.0,
    Ending.MAY_GO_ON: END_S,
    Ending.OPEN: GOES_ON_S,
    Ending.BROKEN_OFF: 1.5,
}
"""How much silence ends an utterance, by its words. They take a part of it to be understood."""
POST_ROLL_S = 0.2
"""Silence that is kept at its end."""
EARLY_S = 0.2
"""After so much silence the utterance may be over, and what will be given is complete already: at
least the post-roll."""
MAX_S = 30.0
"""The longest utterance, as long as Whisper can hear at once; who speaks on begins a new one."""


@dataclass(frozen=True, slots=True)
class SpeechBegan:
    """Somebody speaks, since `began_s` (the clock's time of the first voiced sample)."""

    began_s: float


@dataclass(frozen=True, slots=True)
class SpeechEnded:
    """An utterance, from `began_s` to `ended_s`, the times of its first and last voiced sample.

    `samples` has the pre-roll and the post-roll around them. `cut` if it was as long as may be.
    """

    samples: Samples
    began_s: float
    ended_s: float
    cut: bool = False


@dataclass(frozen=True, slots=True)
class SpeechPaused:
    """Somebody fell silent; if nothing more is said, this is what `SpeechEnded` will give."""

    samples: Samples
    began_s: float
    ended_s: float


@dataclass(frozen=True, slots=True)
class SpeechWentOn:
    """The utterance that had `ended_s`, by its words, goes on: it was not all.

    Its end will give it whole.
    """

    ended_s: float


Signal = SpeechBegan | SpeechPaused | SpeechEnded | SpeechWentOn


class Endpointer:
    """Give it every frame with its probability of voice; it gives back what happened by it.

    Silence ends an utterance. How much may be told for each pause (`end_after`), by whoever knows
    the words. What ended by them may go on after all.
    """

    def __init__(self, *, end_s: float = END_S, max_s: float = MAX_S) -> None:
        self._end_frames = round(end_s / FRAME_S)
        self._max_frames = int(max_s / FRAME_S)
        self._pre_frames = round(PRE_ROLL_S / FRAME_S)
        self._post_frames = round(POST_ROLL_S / FRAME_S)
        self._early_frames = round(EARLY_S / FRAME_S)
        self.reset()

    def reset(self) -> None:
        """Forget everything, an utterance that has begun too."""
        self._speaking = False
        self._voiced: deque[bool] = deque(maxlen=ONSET_WINDOW)
        most = self._pre_frames + ONSET_WINDOW + round(SURMISED_S / FRAME_S)
        self._before: deque[tuple[Frame, bool]] = deque(maxlen=most)
        self._frames: list[Frame] = []
        self._began_s = self._ended_s = 0.0
        self._pause = 0
        self._wanted_frames = self._end_frames
        self._revocable = False
        self._over: SpeechEnded | None = None
        self._over_frames: list[Frame] = []

    @property
    def paused_at(self) -> float | None:
        """When the last voice of the utterance was heard, if somebody has fallen silent since."""
        return self._ended_s if self._speaking and self._pause else None

    def end_after(self, silence_s: float, *, revocable: bool = False) -> None:
        """End the utterance after so much silence, counted from its last voice, for this pause.

        If `revocable` it goes on should somebody speak within `GOES_ON_S`.
        """
        self._wanted_frames = round(silence_s / FRAME_S)
        self._revocable = revocable

    @property
    def speaking(self) -> bool:
        """Whether an utterance has begun and is not over."""
        return self._speaking

    def push(self, frame: Frame, probability: float, *, surmised: bool = False) -> Signal | None:
        """Take the next frame. If a voice in it is `surmised`, what is said may have begun there,
        once it is known that somebody speaks.
        """
        if self._speaking:
            return self._during(frame, probability)
        return self._idle(frame, probability, surmised)

    def finish(self) -> SpeechEnded | None:
        """There are no more frames: the utterance that was going on, if any."""
        return self._end(cut=True) if self._speaking and self._frames else None

    def _idle(
        self, frame: Frame, probability: float, surmised: bool
    ) -> SpeechBegan | SpeechWentOn | None:
        self._voiced.append(probability >= VOICED)
        self._before.append((frame, surmised))
        if self._over:
            self._over_frames.append(frame)
            if frame.end_s - self._over.ended_s > GOES_ON_S + ONSET_WINDOW * FRAME_S:
                self._over, self._over_frames = None, []
        if sum(self._voiced) < ONSET_FRAMES:
            return None
        before = [one for one, _ in self._before]
        first = self._first()
        self._frames = before[-(self._pre_frames + first) :]
        self._began_s = before[-first].end_s - FRAME_S
        self._ended_s = frame.end_s
        self._speaking, self._pause = True, 0
        over, self._over = self._over, None
        if over and self._began_s - over.ended_s <= GOES_ON_S:
            self._frames, self._began_s = self._over_frames, over.began_s
            self._over_frames = []
            return SpeechWentOn(over.ended_s)
        return SpeechBegan(self._began_s)

    def _first(self) -> int:
        """How many frames ago what is said began: where a voice is known first, or surmised."""
        first = len(self._voiced) - list(self._voiced).index(True)
        surmised = [one for _, one in reversed(self._before)]
        latest = min(len(surmised), first + round(SURMISED_S / FRAME_S))
        for ago in range(first, latest):
            if surmised[ago]:
                first = ago + 1
            elif ago - first >= SURMISED_GAP:
                break
        return first

    def _during(self, frame: Frame, probability: float) -> SpeechPaused | SpeechEnded | None:
        self._frames.append(frame)
        if probability < UNVOICED or (self._pause and probability < VOICED):
            self._pause += 1
        else:
            self._pause, self._ended_s = 0, frame.end_s
            self._wanted_frames, self._revocable = self._end_frames, False
        if self._pause >= self._wanted_frames:
            return self._fell_silent()
        if len(self._frames) >= self._max_frames:
            return self._cut(frame)
        if self._pause == self._early_frames and self._ended_s > self._began_s:
            return SpeechPaused(self._kept(), self._began_s, self._ended_s)
        return None

    def _fell_silent(self) -> SpeechEnded | None:
        frames, revocable = self._frames, self._revocable
        nothing = self._ended_s <= self._began_s  # only silence followed on a cut
        ended = self._end(cut=False)
        if revocable:
            self._over, self._over_frames = ended, frames
        return None if nothing else ended

    def _cut(self, frame: Frame) -> SpeechEnded:
        """The utterance is as long as may be; if the person speaks on, so does the next one."""
        pause, ended = self._pause, self._end(cut=True)
        if not pause:
            self._speaking = True
            self._began_s = self._ended_s = frame.end_s
        return ended

    def _end(self, *, cut: bool) -> SpeechEnded:
        ended = SpeechEnded(self._kept(), self._began_s, self._ended_s, cut)
        self.reset()
        return ended

    def _kept(self) -> Samples:
        """All that was heard of the utterance, but for the silence after the post-roll."""
        kept = self._frames[: len(self._frames) - max(0, self._pause - self._post_frames)]
        return np.concatenate([frame.samples for frame in kept])
