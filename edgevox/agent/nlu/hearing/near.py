"""Search by sound for a misheard command or stop word.

`NearCommands` finds "kitchen, please" in "kitchen plate", and `NearStop` finds "freeze" in "Free is
a"; one halt too many is better than one too few.
"""

import difflib
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from edgevox.agent.nlu.hearing.network import Network, Path, Sentences
from edgevox.agent.nlu.hearing.sounds import Phonemes, Sounds, SpanTable, sounds_of
from edgevox.agent.nlu.hearing.wordings import bare_name
from edgevox.agent.nlu.lexicon import words_of
from edgevox.agent.nlu.meaning import HEARD_FROM
from edgevox.agent.nlu.templates import usual_places
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import STOP, Call, Skill, SkillSet
from edgevox.agent.text.spelling import key
from edgevox.core.commands import Hypothesis, Rate
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
that `benchmarks/hearing/people.py` does not report. Of 141 in quiet and in noise at 24, 12 and
6 dB, another order than was meant is done at 6 dB only."""
_UNLIKELY = 0.05
"""Distance that a hypothesis adds which is e times less likely than the first one."""
_LEAST_SHARE = 1e-3
_RATED_LEAD, _MOST_RATED, _RATED_CLEAR = 0.06, 4, 0.9
"""Commands that are so much farther than the nearest one are rated by the sound as well, at most so
many; one that has so much of their probability is clear. Chosen as above."""
_WORDINGS, _MOST_FREE = 2, 4
"""How many wordings of each of them are rated, and how many hypotheses beside them."""
_SURE_WORDS = 0.9
"""Words that are at least so sure are what was said: no short command that has others is done."""
_FARTHER, _FARTHEST = 4.0, 12.0
"""For each word that differs from what was heard and for all of them, in nats: by how much less
likely a clear command may be. "A maricano" is no word that anybody expects."""
_FARTHEST_ASKED = 20.0
"""The same of one that is worth a question."""
_RATED_NEAR = 0.2
"""Share of the sounds that may differ from a clear one."""
_FEW_WORDS, _MANY_WORDS = 3, 8
_HARDLY_HEARD = (HEARD_FROM, 0.6)
"""How sure what was heard must be for a clear one of so few words, and for one of so many: each
word speaks for it."""
_MOST_CHARACTERS = 200
"""Number of characters from which on a sentence is no plain command."""
_WORD = re.compile(r"[^\s\-,.;:!?\u2026\u00bf\u00a1\"]+")


class _Difference(NamedTuple):
    """Where words of a sentence were not heard, or others were."""

    begins: int
    ends: int
    """The place in the text that was heard, in characters."""
    words: list[str]
    """What was heard there."""
    said: list[str]
    """What the sentence has there."""


class _Candidate(NamedTuple):
    """A sentence that a hypothesis sounds like."""

    cost: float
    """Distance, and how much less likely the hypothesis is than the first one."""
    path: Path
    heard: Hypothesis

    @property
    def meaning(self) -> object:
        return self.path.meaning


@dataclass(frozen=True, slots=True)
class NearCommand:
    """A sentence that is a command and sounds like what was heard."""

    words: str
    """The sentence."""
    call: Call
    """What it asks for."""
    heard: Hypothesis
    """What it sounds like."""
    sure: bool
    """True if it may be done without a question."""
    likely: bool
    """True if it is worth a question even where other words were heard well."""
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
        acts = phrasebook(book.code).acts.values()
        usual = (*usual_places(book.code), *(words for one in acts for words in one.words))
        self._small = frozenset(
            word for one in words_of(book.code).all() for word in key(one).split()
        )
        self._usual = frozenset(word for one in usual for word in key(one).split()) - self._small
        self._words: object = None
        self._network = Network((), {}, self._sounds)
        self._last: tuple[object, NearCommand | None] | None = None
        """What was asked last, for the same turn asks twice, and the answer."""

    def nearest(
        self, several: Sequence[Hypothesis], rate: Rate | None = None
    ) -> NearCommand | None:
        """The one command that these hypotheses sound like, or None.

        Of several that they sound like, `rate` tells which one the sound is most like.
        """
        if not self._book.hearing.spaced:
            return None
        self._learn()
        asked, last = (tuple(several), rate), self._last
        if last is None or last[0] != asked:
            self._last = last = (asked, self._nearest(several, rate))
        return last[1]

    def _nearest(self, several: Sequence[Hypothesis], rate: Rate | None) -> NearCommand | None:
        most = max(one.share for one in several)
        lead = _RATED_LEAD if rate else _LEAD
        near = [(one, self._sentences_like(one.text, lead)) for one in several]
        found = [
            _Candidate(
                path.distance + _UNLIKELY * math.log(most / max(one.share, _LEAST_SHARE)), path, one
            )
            for one, paths in near
            for path in paths
        ]
        if not found:
            return None
        found.sort(key=lambda one: one.cost)
        first = found[0]
        others = (one.cost - first.cost for one in found if one.meaning != first.meaning)
        like = (one.share for one, paths in near if paths and paths[0].meaning == first.meaning)
        mass = sum(like)
        clear = (
            first.path.distance <= CLEAR
            and min(others, default=_LEAD) >= _LEAD
            and mass >= _CLEAR_MASS
            and not self._swaps_a_word(first.heard.text, first.path)
            and not (self._swaps_sure_words(first, several) and self._is_short(first.path))
        )
        if rate:
            rated = self._rated(found, several, rate)
            if rated is None:
                return None
            best, likely, sure = rated
            clear = clear and best.meaning == first.meaning
        elif mass < _LEAST_MASS:
            return None
        else:
            best, likely, sure = first, False, False
        choices = self._skills[best.path.of.skill].choices
        values = {slot: self._book.heard(choices[slot])[said] for slot, said in best.path.values}
        call = Call(best.path.of.skill, values)
        return NearCommand(
            words=best.path.words,
            call=call,
            heard=best.heard,
            sure=sure or (clear and best.heard.confidence >= HEARD_FROM),
            likely=likely or clear,
            alone=best.path.of.alone and not self._says_another(best),
        )

    def _rated(
        self, found: Sequence[_Candidate], several: Sequence[Hypothesis], rate: Rate
    ) -> tuple[_Candidate, bool, bool] | None:
        """The candidate that the sound is most like; whether it is likely, and whether it is sure.

        Each candidate is rated as what was heard, with only the words that differ replaced by the
        command's. None if the sound is far more like the words that were heard.
        """
        wordings: dict[object, list[_Candidate]] = {}
        for one in found:
            if one.cost <= found[0].cost + _RATED_LEAD:
                wordings.setdefault(one.meaning, []).append(one)
        rated = [one for same in [*wordings.values()][:_MOST_RATED] for one in same[:_WORDINGS]]
        differences = [self._differences(one.heard.text, one.path.words) for one in rated]
        corrected = [*map(_corrected, (one.heard.text for one in rated), differences)]
        heard = [one.text for one in several[:_MOST_FREE]]
        likelihoods = rate([*corrected, *heard])
        free, likeliest = max(zip(likelihoods[len(rated) :], heard, strict=True))
        of: dict[object, int] = {}
        for at, one in enumerate(rated):
            if one.meaning not in of or likelihoods[at] > likelihoods[of[one.meaning]]:
                of[one.meaning] = at
        first, *others = sorted(of.values(), key=lambda at: likelihoods[at], reverse=True)
        rest = sum(math.exp(likelihoods[at] - likelihoods[first]) for at in others)
        best = rated[first]
        apart = self._differences(likeliest, corrected[first])
        swapped = sum(max(len(one.words), len(one.said)) for one in apart)
        farther = free - likelihoods[first]
        if farther > _FARTHEST_ASKED:
            return None
        words, confidence = len(self._spoken(best.path.words)), best.heard.confidence
        swaps_sure_words = self._swaps_sure_words(best, several)
        likely = (
            1.0 / (1.0 + rest) >= _RATED_CLEAR
            and farther <= min(_FARTHER * max(1, swapped), _FARTHEST)
            and best.path.distance <= _RATED_NEAR
            and not (swaps_sure_words and self._is_short(best.path))
        )
        sure = (
            likely
            and confidence >= float(np.interp(words, (_FEW_WORDS, _MANY_WORDS), _HARDLY_HEARD))
            and not swaps_sure_words
            and not self._swaps_a_known_word(differences[first], best.path)
        )
        return best, likely, sure

    def _is_short(self, path: Path) -> bool:
        """True for a sentence of so few words that each of them may change what is wanted."""
        return len(self._spoken(path.words)) < _MANY_WORDS

    def _swaps_sure_words(self, one: _Candidate, several: Sequence[Hypothesis]) -> bool:
        """True if the sentence has other words than what was surely heard."""
        swapped = one.heard is not several[0]
        return several[0].confidence >= _SURE_WORDS and (
            swapped or bool(self._differences(one.heard.text, one.path.words))
        )

    def _swaps_a_word(self, heard: str, path: Path) -> bool:
        """True if words that were heard sound unlike what the sentence has in their place.

        "Bring the mug to the bedroom" sounds much like "bring me to the bedroom", as a whole.
        """
        differences = self._differences(heard, path.words)
        for one in differences:
            if one.words:
                table = SpanTable([self._sounds(" ".join(one.said))])
                if table.distances(self._sounds(" ".join(one.words)))[0] > _WORD_CLEAR:
                    return True
        return self._swaps_a_known_word(differences, path)

    def _swaps_a_known_word(self, differences: Sequence[_Difference], path: Path) -> bool:
        """True if the sentence has another word for one that the robot knows, or more of a value.

        A medium roast is not iced, and a mocha is no iced mocha. The words of usual places and of
        what people ask for in a house are known, too: a bathroom is no bedroom.
        """
        values = {word for _, value in path.values for word in self._spoken(value)}
        return any(
            not (self._network.words | self._usual).isdisjoint(map(key, one.words))
            or (not one.words and not values.isdisjoint(map(key, one.said)))
            for one in differences
        )

    def _says_another(self, one: _Candidate) -> bool:
        """True if each word that the sentence has another for is known: "salut" is no "salon"."""
        differences = self._differences(one.heard.text, one.path.words)
        words = {key(word) for each in differences for word in each.words}
        return bool(words) and words <= self._usual | self._small

    def _differences(self, heard: str, sentence: str) -> list[_Difference]:
        """Where the words of a sentence differ from what was heard, but for articles."""
        words, said = (
            [one for one in _WORD.finditer(text) if self._plain(one[0]) not in self._articles]
            for text in (heard, sentence)
        )
        changes = difflib.SequenceMatcher(
            None,
            [self._plain(one[0]) for one in words],
            [self._plain(one[0]) for one in said],
            autojunk=False,
        ).get_opcodes()
        found = []
        for what, start, end, first, last in changes:
            if what != "equal":
                before = words[start - 1].end() if start else 0
                some = start < end
                found.append(
                    _Difference(
                        words[start].start() if some else before,
                        words[end - 1].end() if some else before,
                        [one[0] for one in words[start:end]],
                        [one[0] for one in said[first:last]],
                    )
                )
        return found

    def _plain(self, word: str) -> str:
        return digits(key(word), self._book.code).strip()

    def _spoken(self, text: str) -> list[str]:
        """Its words without articles."""
        return [word for word in key(text).split() if word not in self._articles]

    def _sentences_like(self, text: str, margin: float) -> list[Path]:
        if not 0 < len(text) <= _MOST_CHARACTERS:
            return []
        paths = self._network.nearest(text, NEAR, margin)
        numbers = self._numbers(text)
        return [path for path in paths if self._numbers(path.words) == numbers]

    def _numbers(self, text: str) -> list[str]:
        return [one for one in digits(key(text), self._book.code).split() if one.isdigit()]

    def _learn(self) -> None:
        """Rebuild the network if the words of arguments have changed: places are learned."""
        words = self._skills.words()
        if words == self._words:
            return
        self._words, self._last = words, None
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


def _corrected(heard: str, differences: Sequence[_Difference]) -> str:
    """What was heard, with the words of a sentence in place of those that differ."""
    text = heard
    for one in reversed(differences):
        text = f"{text[: one.begins]} {' '.join(one.said)} {text[one.ends :]}"
    text = " ".join(re.sub(r"\s+([-,.;:!?])", r"\1", text).split())
    return text[:1].upper() + text[1:]
