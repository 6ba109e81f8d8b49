"""The endpointer: finds where speech begins and ends, a state machine over frames.

The silence that ends an utterance is shorter or longer by its words so far, which
`edgevox.agent.nlu.hearing.endings` judges and `listener` asks for.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from edgevox.core.speech import Ending
from edgevox.voice.audio import FRAME_S, Frame, Samples

VOICED = 0.5
"""A frame is voiced from this probability on."""
UNVOICED = 0.35
"""Below it a frame of speech is a pause; in between, it goes on as it was."""
ONSET_FRAMES = 5
"""Voiced frames that begin speech (0.16 s): a click or a cough is shorter, "no" is longer."""
ONSET_WINDOW = 7
"""The onset's voiced frames must lie within this many frames."""
SURMISED_ONSET_FRAMES = 3
"""Voiced frames that begin speech where `ONSET_FRAMES` of the window hold a surmised voice: through
the robot's own, a short "no" leaves little. Of 17 short words by the tuning voices that were missed
7 are noticed; in 10 minutes of the robot's own voice not even 2 frames were voiced so."""
PRE_ROLL_S = 0.3
"""Heard before the first voiced frame: consonants are quiet."""
SURMISED_S = 0.8
"""Seconds before the first known voice in which speech may already have begun (`surmised`)."""
SURMISED_GAP = 3
"""Frames without a surmised voice that end the search for an earlier beginning."""
END_S = 0.6
"""Silence that ends an utterance: people pause for less within a sentence."""
GOES_ON_S = 1.0
"""Speech within this long after an utterance that its words ended continues it: few pauses
within a sentence exceed 0.8 s, and a soft end or beginning is no voice for 0.1 s more."""
ENDS_AFTER_S: Mapping[Ending, float] = {
    Ending.FINAL: 0.0,
    Ending.WHOLE: 0.0,
    Ending.MAY_GO_ON: END_S,
    Ending.OPEN: GOES_ON_S,
    Ending.BROKEN_OFF: 1.5,
}
"""Silence that ends an utterance, by how its words end. Speech to text takes a part of it; until
the words are known, they may break off."""
POST_ROLL_S = 0.2
"""Silence that is kept at its end."""
EARLY_S = 0.2
"""Silence after which the utterance may be over: its sound is complete by then, at least with
the post-roll."""
MAX_S = 30.0
"""The longest utterance, as long as Whisper can hear at once; longer speech begins a new one."""


@dataclass(frozen=True, slots=True)
class SpeechBegan:
    """A person began to speak."""

    began_s: float
    """The clock's time of the first voiced sample, in seconds."""


@dataclass(frozen=True, slots=True)
class SpeechEnded:
    """A whole utterance."""

    samples: Samples
    """The sound, with the pre-roll and the post-roll."""
    began_s: float
    """The clock's time of the first voiced sample, in seconds."""
    ended_s: float
    """The clock's time of the last voiced sample, in seconds."""
    cut: bool = False
    """True if it reached the longest duration (`MAX_S`), or the sound ended first."""


@dataclass(frozen=True, slots=True)
class SpeechPaused:
    """The speaker fell silent; unless speech goes on, `SpeechEnded` will hold the same."""

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
    """Turns frames and their voice probabilities into the beginning, pauses and end of speech.

    Silence ends an utterance after `end_s` seconds, or, once its words are known, after the silence
    that `end_after` sets for this pause. An utterance that its words ended may still go on
    (`SpeechWentOn`). `max_s` is the longest utterance in seconds.
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
        """The clock's time of the last voice, if the speaker has fallen silent since; else None."""
        return self._ended_s if self._speaking and self._pause else None

    def end_after(self, silence_s: float, *, revocable: bool = False) -> None:
        """End the utterance after this silence, counted from its last voice, for this pause.

        If `revocable`, speech within `GOES_ON_S` continues it.
        """
        self._wanted_frames = round(silence_s / FRAME_S)
        self._revocable = revocable

    @property
    def speaking(self) -> bool:
        """Whether an utterance has begun and is not over."""
        return self._speaking

    def push(self, frame: Frame, probability: float, *, surmised: bool = False) -> Signal | None:
        """Take the next frame.

        If a voice in it is `surmised`, speech may have begun there, once it is known that a person
        speaks.
        """
        if self._speaking:
            return self._during(frame, probability)
        return self._idle(frame, probability, surmised)

    def finish(self) -> SpeechEnded | None:
        """End the input: return the unfinished utterance, if any."""
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
        if sum(self._voiced) < self._fewest_voiced():
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

    def _fewest_voiced(self) -> int:
        """Return how many frames of the window must be voiced for speech to begin."""
        lately = [surmised for _, surmised in self._before][-ONSET_WINDOW:]
        return SURMISED_ONSET_FRAMES if sum(lately) >= ONSET_FRAMES else ONSET_FRAMES

    def _first(self) -> int:
        """Return how many frames ago the speech began.

        Where a voice is known first, or surmised.
        """
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
