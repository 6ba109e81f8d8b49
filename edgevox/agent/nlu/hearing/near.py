"""Search by sound for a misheard command or stop word.

`NearCommands` finds "kitchen, please" in "kitchen plate", and `NearStop` finds "freeze" in "Free is
a"; one halt too many is better than one too few.
"""

import difflib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.hearing.network import Network, Path, Sentences
from edgevox.agent.nlu.hearing.sounds import Phonemes, Sounds, SpanTable, sounds_of
from edgevox.agent.nlu.hearing.wordings import bare_name
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import STOP, Call, Skill, SkillSet
from edgevox.agent.text.spelling import key
from edgevox.core.commands import Hypothesis
from edgevox.core.languages import STOP_WORDS

_NEAR = 0.35
"""Share of the sounds that may differ from a stop word: it accepts "free is a" for "freeze" but not
"shop" for "stop"."""
_MOST_WORDS = 3
_USUAL = 3
"""Number of single words from a language's table; later ones are rare, or misspelt."""
_FEWEST_SOUNDS = 3
"""Least number of sounds: a shorter stop word is near to too many words."""


class NearStop:
    """Finds stop words of one language and of English by their sounds."""

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
        self._table = SpanTable([sounds for _, sounds in known])

    def find(self, text: str) -> str | None:
        """The stop word that the whole of a short utterance sounds like, or None."""
        if not self._words or not 0 < len(text.split()) <= _MOST_WORDS:
            return None
        distances = self._table.distances(self._sounds(text))
        best = int(distances.argmin())
        return self._words[best] if distances[best] <= _NEAR else None

    def _sounds(self, text: str) -> Sounds:
        return sounds_of(self._phonemes(text, self._code))


def _usual(code: str) -> list[str]:
    return [word for word in STOP_WORDS[code].anywhere if " " not in word][:_USUAL]


NEAR, CLEAR = 0.35, 0.15
"""Share of the sounds that may differ from a command, and from one that is clear."""
_LEAD = 0.02
"""How much farther all other commands must be from the words than a clear one."""
_WORD_CLEAR = 0.55
"""Share of the sounds that may differ in a single place of a clear command."""
_LEAST_MASS, _CLEAR_MASS = 0.2, 0.7
"""Share of the hypotheses that must sound most like a command, and like a clear one.
All of these were chosen with real people's orders to a coffee machine, by the half of the speakers
that `benchmarks/hearing/people.py` does not report: of 141 in quiet and in noise at 24, 12 and 6 dB
no other order was done."""
_UNLIKELY = 0.05
"""Distance that a hypothesis adds which is e times less likely than the first one."""
_LEAST_SHARE = 1e-3
_MOST_CHARACTERS = 200
"""Number of characters from which on a sentence is no plain command."""


@dataclass(frozen=True, slots=True)
class NearCommand:
    """A sentence that is a command and sounds like what was heard."""

    words: str
    """The sentence."""
    call: Call
    """What it asks for."""
    heard: Hypothesis
    """What it sounds like."""
    clear: bool
    """True if it sounds much like it, and nothing else does."""
    alone: bool
    """True if it is only a name, without a word for what to do."""


class NearCommands:
    """Finds plain commands of a set of skills in one language by their sounds.

    Finds nothing in languages without spaces, which espeak-ng cannot read. A command has the
    numbers that were heard, and only those in names are in one.
    """

    def __init__(self, skills: SkillSet, book: Phrasebook, phonemes: Phonemes) -> None:
        self._skills = skills
        self._book = book
        self._phonemes = phonemes
        self._articles = frozenset(book.hearing.articles)
        self._words: object = None
        self._network = Network((), {}, self._sounds)

    def nearest(self, several: Sequence[Hypothesis]) -> NearCommand | None:
        """The one command that these hypotheses sound like, or None."""
        if not self._book.hearing.spaced:
            return None
        self._learn()
        most = max(one.share for one in several)
        near = [(one, self._sentences_like(one.text)) for one in several]
        found = [
            (path.distance + _UNLIKELY * math.log(most / max(one.share, _LEAST_SHARE)), path, one)
            for one, paths in near
            for path in paths
        ]
        if not found:
            return None
        cost, best, heard = min(found, key=lambda one: one[0])
        others = (other - cost for other, path, _ in found if path.meaning != best.meaning)
        lead = min(others, default=_LEAD)
        mass = sum(one.share for one, paths in near if paths and paths[0].meaning == best.meaning)
        if mass < _LEAST_MASS:
            return None
        clear = best.distance <= CLEAR and lead >= _LEAD and mass >= _CLEAR_MASS
        clear = clear and not self._swaps_a_word(heard.text, best.words)
        choices = self._skills[best.of.skill].choices
        values = {slot: self._book.heard(choices[slot])[said] for slot, said in best.values}
        call = Call(best.of.skill, values)
        return NearCommand(best.words, call, heard, clear, best.of.alone)

    def _swaps_a_word(self, heard: str, sentence: str) -> bool:
        """True if words that were heard sound unlike what the sentence has in their place.

        "Bring the mug to the bedroom" sounds much like "bring me to the bedroom", as a whole.
        """
        words, said = self._spoken(heard), self._spoken(sentence)
        changes = difflib.SequenceMatcher(None, words, said, autojunk=False).get_opcodes()
        for what, start, end, first, last in changes:
            sounds = self._sounds(" ".join(words[start:end])) if what != "equal" else ()
            if sounds:  # none where the sentence only has words more
                table = SpanTable([self._sounds(" ".join(said[first:last]))])
                if table.distances(sounds)[0] > _WORD_CLEAR:
                    return True
        return False

    def _spoken(self, text: str) -> list[str]:
        """Its words without articles."""
        return [word for word in key(text).split() if word not in self._articles]

    def _sentences_like(self, text: str) -> list[Path]:
        if not 0 < len(text) <= _MOST_CHARACTERS:
            return []
        paths = self._network.nearest(text, NEAR, _LEAD)
        numbers = self._numbers(text)
        return [path for path in paths if self._numbers(path.words) == numbers]

    def _numbers(self, text: str) -> list[str]:
        return [one for one in digits(key(text), self._book.code).split() if one.isdigit()]

    def _learn(self) -> None:
        """Rebuild the network if the words of arguments have changed: places are learned."""
        words = self._skills.words()
        if words == self._words:
            return
        self._words = words
        several = [
            sentences
            for one in self._skills.values()
            if not one.lasting and one.name != STOP
            for sentences in self._sentences(one)
        ]
        self._network = Network(several, self._book.rules, self._sounds)

    def _sentences(self, one: Skill) -> Iterator[Sentences]:
        """What may be said for a skill, and the bare names of a drive that needs only a name."""
        names = {slot: tuple(self._book.heard(words)) for slot, words in one.choices.items()}
        yield Sentences(one.name, tuple(self._book.templates(one)), names)
        if needed := bare_name(one):
            polite = next(iter(self._book.answers.polite), "")
            template = f"{{{needed}}} [{polite}]" if polite else f"{{{needed}}}"
            yield Sentences(one.name, (template,), names, alone=True)

    def _sounds(self, text: str) -> Sounds:
        """The sounds of a text without articles, which are hardly spoken."""
        words = " ".join(self._spoken(text))
        return sounds_of(self._phonemes(words, self._book.code)) if words else ()
