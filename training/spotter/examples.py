"""Examples to learn from: clips among silence and other speech, before anybody hears them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stop_spotter.network import SAMPLES
from training.whisper.tracks import Drawn, Wave, silence, varied

TRACK_S = 3.2
"""How long an example is; what looks at it has all of what it looks at."""
IGNORED = -1
"""The label of a look that is not judged: it may hear the word or not."""
HEARD_S, HEARD_WITHIN_S = 0.24, (0.5, 0.75)
"""For so long after its end a word is to be heard; after its beginning, where more is said."""
BEFORE_S, PAST_S = 0.05, 0.5
"""A look up to so soon after a word begins does not hear it, nor one so long after its end: a word
is to be heard once, though it is seen for longer.
"""
ANYWHERE = 6
"""So many looks at an example with a word are anywhere, one more where there is none."""
_LEAD_S, _TAIL_S = 0.6, 0.35
_FIRST_S = SAMPLES / RATE_HZ + 0.005
_WITH_WORD = 0.5


@dataclass(frozen=True, slots=True)
class Sound:
    """A clip in memory: `word` counts from 1, 0 for none."""

    samples: NDArray[np.int16]
    word: int
    within: bool
    weight: float = 1.0


@dataclass(frozen=True, slots=True)
class Example:
    """What is said in `TRACK_S`, and the stop word in it, if any, from when to when."""

    track: Wave
    word: int = 0
    within: bool = False
    begins_s: float = 0.0
    ends_s: float = 0.0

    def label(self, when_s: float) -> int:
        """What a look at this time is to find: a word, 0 for none, or `IGNORED`."""
        if not self.word:
            return 0
        first, last = self._heard_s
        if first <= when_s <= last:
            return self.word
        before, after = when_s < self.begins_s + BEFORE_S, when_s > self.ends_s + PAST_S
        return 0 if before or after else IGNORED

    def times(self, rng: np.random.Generator) -> list[float]:
        """When to look at it: some anywhere, others where the word is to be heard or has been."""
        latest = self.track.size / RATE_HZ
        many = ANYWHERE if self.word else ANYWHERE + 1
        anywhere = [float(when) for when in rng.uniform(_FIRST_S, latest, many)]
        if not self.word:
            return anywhere
        said = [
            *rng.uniform(*self._heard_s, 2),
            self.ends_s + rng.uniform(PAST_S, SAMPLES / RATE_HZ),
        ]
        return [*anywhere, *(float(np.clip(when, _FIRST_S, latest)) for when in said)]

    @property
    def _heard_s(self) -> tuple[float, float]:
        """From when to when the word is to be heard."""
        if self.within:
            soonest, latest = HEARD_WITHIN_S
            return self.begins_s + soonest, self.begins_s + latest
        return self.ends_s, self.ends_s + HEARD_S


class Examples:
    """Makes examples of these sounds, with each word as often as the next, or as `shares` say."""

    def __init__(
        self,
        sounds: Sequence[Sound],
        rng: np.random.Generator,
        shares: Sequence[float] | None = None,
    ) -> None:
        self._rng, self._shares = rng, shares
        self._words = [
            [s for s in sounds if s.word == number]
            for number in range(1 + max(s.word for s in sounds))
        ]
        self._drawn = [Drawn(np.array([s.weight for s in some])) for some in self._words]

    def make(self) -> Example:
        """The next one."""
        rng, track = self._rng, silence(TRACK_S)
        if rng.random() < _WITH_WORD:
            return self._with_word(self._word(), track)
        if rng.random() < 0.95:
            self._chatter(track, int(rng.uniform(0, 1.2) * RATE_HZ), track.size)
        return Example(track)

    def _word(self) -> int:
        if self._shares is None:
            return int(self._rng.integers(1, len(self._words)))
        return 1 + int(self._rng.choice(len(self._shares), p=self._shares))

    def _with_word(self, word: int, track: Wave) -> Example:
        rng, sound = self._rng, self._sound(word)
        clip = varied(sound.samples, rng)
        least = int(_LEAD_S * RATE_HZ)
        latest = track.size - clip.size - int(_TAIL_S * RATE_HZ)
        start = int(rng.integers(least, max(least + 1, latest)))
        end = start + clip.size
        _put(track, clip, start)
        if rng.random() < 0.5:
            self._chatter(track, 0, start - int(rng.uniform(0.03, 0.5) * RATE_HZ))
        if rng.random() < 0.4 and not sound.within:
            self._chatter(track, end + int(rng.uniform(0.06, 0.5) * RATE_HZ), track.size)
        return Example(track, word, sound.within, start / RATE_HZ, end / RATE_HZ)

    def _sound(self, word: int) -> Sound:
        return self._words[word][self._drawn[word].one(self._rng)]

    def _chatter(self, track: Wave, begin: int, end: int) -> None:
        """Other speech, up to here; what ends before does not begin with the clip's beginning."""
        rng, at = self._rng, begin
        while at < end:
            clip = varied(self._sound(0).samples, rng)
            if rng.random() < 0.3:
                clip = clip[int(rng.uniform(0, 0.7) * clip.size) :]
            if end < track.size:
                clip = clip[-(end - at) :] if clip.size > end - at else clip
            _put(track, clip * 10 ** (rng.uniform(-6, 3) / 20), at)
            at += clip.size + int(rng.uniform(0.02, 0.5) * RATE_HZ)


def _put(track: Wave, clip: Wave, at: int) -> None:
    """Add a clip to a track; what does not fit is left out."""
    begin, end = max(0, at), min(track.size, at + clip.size)
    if end > begin:
        track[begin:end] += clip[begin - at : end - at]
