"""Which output of the networks is for which word of which language.

English has a network of its own, all other languages one together, of which each has its own
outputs. Who speaks a language is judged by its outputs alone; the first is for none of its words.
"""

from collections import Counter
from collections.abc import Sequence

from training.acoustics import Half, people
from training.acoustics import languages as others
from training.acoustics.clips import Clip
from training.acoustics.mixing import voiced_part
from training.spotter import texts
from training.spotter.examples import IGNORED, Sound

ENGLISH = "en"
SHARES = {"kokoro": 0.55, "espeak": 0.42, "piper": 0.03}
"""How much of what is drawn each engine says, however many clips of it there are."""
PEOPLE = 1.0
"""Weight of people beside all synthetic voices, for the stop word and for other words."""
NATIVE = 2.0
"""How often a clip of a native voice is drawn beside another of Kokoro's."""


def words_of(language: str) -> tuple[str, ...]:
    """Those that are known by their sound."""
    return texts.WORDS if language == ENGLISH else others.words(language)


class Outputs:
    """Of English and these languages, in this order."""

    def __init__(self, languages: Sequence[str]) -> None:
        named = [(code, word) for code in (ENGLISH, *languages) for word in ("", *words_of(code))]
        self.languages = [code for code, _ in named]
        self.words = [word for _, word in named]

    def __len__(self) -> int:
        return len(self.words)

    @property
    def of_english(self) -> int:
        """How many are English: the first ones."""
        return self.languages.count(ENGLISH)

    def wanted(self, language: str, label: int) -> tuple[int, int]:
        """Which output a look at an example is to find, of its language and of English, or
        `IGNORED`. A word that is no English one may sound like one.
        """
        if label == IGNORED:
            return IGNORED, IGNORED
        own = self.languages.index(language) + label
        if language == ENGLISH:
            return IGNORED, own
        word = self.words[own]
        if word in ("", *texts.WORDS):
            return own, self.words.index(word)
        return own, IGNORED


def sounds_of(language: str, clips: Sequence[Clip]) -> list[Sound]:
    """The clips in this language, spoken."""
    known = ("", *words_of(language))
    whole: Counter[tuple[str, str]] = Counter()
    for clip in clips:
        whole[clip.word, clip.engine] += _weight(language, clip)
    return [
        Sound(
            clip.samples, known.index(clip.word), clip.within,
            SHARES[clip.engine] * _weight(language, clip) / whole[clip.word, clip.engine],
        )
        for clip in clips
    ]  # fmt: skip


def sounds_of_people() -> list[Sound]:
    """The recordings that train: the stop word, and other words. Empty without a folder."""
    some = [one for one in people.recordings() if one.part is Half.TRAIN]
    whole = Counter(one.word == people.STOP for one in some)
    return [
        Sound(
            voiced_part(one.samples), 1 if one.word == people.STOP else 0, False,
            PEOPLE / whole[one.word == people.STOP],
        )
        for one in some
    ]  # fmt: skip


def _weight(language: str, clip: Clip) -> float:
    native = language != ENGLISH and others.is_native(clip.voice, language)
    return NATIVE if native else 1.0
