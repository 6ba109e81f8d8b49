"""A stop word that was nearly heard: "Free is a" for "freeze". Rather a halt too many."""

from edgevox.agent.nlu.sounds import Phonemes, SoundTable, sounds_of
from edgevox.core.stop_words import STOP_WORDS

_NEAR = 0.35
"""So great a share of the sounds may differ: "free is a" is as near to "freeze", "shop" is not to
"stop"."""
_MOST_WORDS = 3
_USUAL = 3
"""The first single words of a language's table; later ones are rare, or misspelt."""
_FEWEST_SOUNDS = 3
"""What is shorter is near to too much."""


class NearStop:
    """The stop words of one language, and of English, by their sounds."""

    def __init__(self, code: str, phonemes: Phonemes) -> None:
        self._code = code
        self._phonemes = phonemes
        said = [
            (word, self._sounds(word))
            for one in dict.fromkeys((code, "en"))
            for word in _usual(one)
        ]
        known = [(word, sounds) for word, sounds in said if len(sounds) >= _FEWEST_SOUNDS]
        self._words = [word for word, _ in known]
        self._table = SoundTable([sounds for _, sounds in known])

    def find(self, text: str) -> str | None:
        """The stop word that a whole short utterance sounds like, or None."""
        if not self._words or not 0 < len(text.split()) <= _MOST_WORDS:
            return None
        distances = self._table.distances(self._sounds(text), _NEAR)
        best = int(distances.argmin())
        return self._words[best] if distances[best] <= _NEAR else None

    def _sounds(self, text: str) -> tuple[int, ...]:
        return sounds_of(self._phonemes(text, self._code))


def _usual(code: str) -> list[str]:
    return [word for word in STOP_WORDS[code].anywhere if " " not in word][:_USUAL]
