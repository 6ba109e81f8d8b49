"""The search for stop words in an utterance; a stop word halts the robot without any model.

Of the spoken language and of English, `anywhere` words count in any utterance, `last` and `alone`
words only at the end of a clause or alone in it, and none in an innocent phrase ("the bus stop").
Stop words of the other languages count only alone or first, and not if the spoken language uses the
same word. `[stop]` of `core/languages/*.toml` has the words, `stopping` acts on them.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import chain

from edgevox.agent.stop.spelling import SpelledWord, readings, spelled_out, words
from edgevox.core.files.text import one_form
from edgevox.core.languages import LANGUAGES, STOP_SIGNS, STOP_WORDS, StopWords

MAX_CHARACTERS = 4000
"""Number of characters that are searched in one go; a longer text is searched in parts."""
OVERLAP = 200
"""Number of characters that two parts share: room for a stop word and the innocent phrase around
it."""
WHOLE_PARTS = 5
"""Number of parts at each end of a long text that are searched in full."""
MOST_FOUND = 64
"""Number of stop words in the middle of a long text that stop the robot, even if each stands in an
innocent phrase."""
_ALONE_MIN = 5
"""A shorter word of another language must be written exactly, with its accents, to count."""
_UNSPACED = ("ja", "zh")
_SPELLED_MIN = 3
_CLAUSE_END = "."
_NO = "no"
_AROUND = " ,;:.!\u2026\u3001\u3002\u060c\u0964\uff0c\uff01"

Phrase = tuple[SpelledWord, ...]


@dataclass(frozen=True, slots=True)
class _Found:
    """A stop word at `start` of a reading, up to but without `end`."""

    word: str
    start: int
    end: int


class SafetyWords:
    """Finds a stop word of one language (English ones always count too) in an utterance.

    A stop word counts anywhere, so that "hold it there, stop", "No! Don't! Stop!" and "go to the
    kitchen, no, stop" all halt: one halt too many is better than one too few. A stop word does not
    count if it is part of an innocent phrase in the same clause ("don't stop", "bus stop"). Some
    everyday words count only at the end of a clause, or alone: see `core/languages/en.toml`. Those
    that hesitate ("wait") also count where they open what is said to a robot that moves (`opens`).
    """

    def __init__(self, code: str) -> None:
        self._code = code
        _rules(code).prepare()

    def find(self, text: str) -> str | None:
        """The stop word in this utterance, as the table spells it, or None."""
        return find_stop_word(self._code, text)

    def opens(self, text: str) -> str | None:
        """The stop word that hesitates and opens this utterance: "oh wait, I wasn't ready"."""
        opening = (_rules(self._code).opens(one) for one in readings(text[:MAX_CHARACTERS]))
        return next(filter(None, opening), None)

    def before(self, word: str, text: str) -> str:
        """The text before the last place of this stop word; empty if it is spelled otherwise."""
        spaced = LANGUAGES[self._code].spaced
        edge = (r"(?<!\w)", r"(?!\w)") if spaced else ("", "")
        found = [*re.finditer(re.escape(word).join(edge), text, re.IGNORECASE)]
        return text[: found[-1].start()].rstrip() if found else ""

    def around(self, word: str, text: str) -> tuple[str, str]:
        """The text before and after this stop word, if people go on after it: "wait, the office".

        Both are empty for any other stop word, and where nothing follows.
        """
        found = [*_hesitating(self._code).finditer(text)] if word in _hesitant(self._code) else []
        after = text[found[-1].end() :].strip(_AROUND) if found else ""
        return (text[: found[0].start()].strip(_AROUND), after) if after else ("", "")


@lru_cache
def _hesitant(code: str) -> frozenset[str]:
    return frozenset((*STOP_WORDS[code].hesitant, *STOP_WORDS["en"].hesitant))


@lru_cache
def _hesitating(code: str) -> re.Pattern[str]:
    said = "|".join(map(re.escape, sorted(_hesitant(code), key=len, reverse=True)))
    whole = rf"(?<!\w)(?:{said})(?!\w)" if LANGUAGES[code].spaced else f"(?:{said})"
    return re.compile(whole if said else "(?!)", re.IGNORECASE)


def find_stop_word(code: str, text: str) -> str | None:
    """The stop word in a text of any language, or None, without an object to keep.

    The tables of innocent phrases are built only when a stop word is found.
    """
    for part in _parts(text, code):
        for reading in readings(part):
            if found := _rules(code).find(reading):
                return found
    for reading in readings(text[:MAX_CHARACTERS]):
        if found := _foreign(code).find(reading):
            return found
    return None


def denies_stop(code: str, text: str, *, begins: bool = False) -> bool:
    """True if a text says not to stop, and nothing more: "please don't stop".

    More may follow if it only `begins` so: "don't stop until you are there".
    """
    if len(text) > MAX_CHARACTERS or find_stop_word(code, text):
        return False
    return any(_rules(code).denies(reading, begins=begins) for reading in readings(text))


class _Rules:
    """Lookup tables for the stop words of one language and of English."""

    def __init__(self, code: str) -> None:
        own = STOP_WORDS[code]
        tables = [own] if code == "en" else [own, _without(STOP_WORDS["en"], own.ordinary)]
        self._others = {other.casefold() for table in tables for other in table.others}
        self._anywhere = _index([*(table.anywhere for table in tables), STOP_SIGNS])
        self._last = _index(table.last for table in tables)
        self._alone = _index(table.alone for table in tables)
        self._courtesies = _index(table.courtesies for table in tables)
        self._hesitant = _index(table.hesitant for table in tables)
        self._tables = tables
        single = [
            (phrase[0], said)
            for phrases in self._anywhere.values()
            for phrase, said in phrases
            if len(phrase) == 1
        ]
        self._whole = {word.bare: said for word, said in single}
        self._exact = {word.exact for word, _ in single}
        self._begun: dict[str, list[str]] = defaultdict(list)
        for bare in self._whole:
            self._begun[bare[:2]].append(bare)

    def prepare(self) -> None:
        """Build the innocent phrases now, so that the first stop word does not wait for them."""
        self._excused.reach  # noqa: B018 - the first access builds it

    @cached_property
    def _excused(self) -> "_Excused":
        """Innocent phrases: slow to build, and needed only for a text with a stop word."""
        return _Excused(_innocent(self._tables))

    def denies(self, reading: Phrase, *, begins: bool) -> bool:
        """True if a reading is made of denials of a stop and courtesies around them."""
        rest, denied = _bare(reading), False
        while rest:
            sizes = range(len(rest), 0, -1)
            denial = next((size for size in sizes if rest[:size] in self._denials), 0)
            size = denial or next((size for size in sizes if rest[:size] in self._quiet), 0)
            if not size or (denied and begins):
                return denied and begins
            rest, denied = rest[size:], denied or denial > 0
        return denied

    def opens(self, reading: Phrase) -> str | None:
        """The stop word that hesitates and opens a reading, behind courtesies at most.

        It is written with its accents ("cho" is no "chờ"). A word that denies is none of these
        courtesies: "nie czekaj" is no "czekaj".
        """
        hesitant = {
            one.start: one.word
            for one in self._in(reading, self._hesitant)
            if _exact(reading[one.start : one.end]) == _exact(words(one.word))
        }
        quiet: dict[int, int] = {}
        for one in self._in(reading, self._courtesies):
            if reading[one.start].bare not in self._denying:
                quiet[one.start] = max(one.end, quiet.get(one.start, 0))
        at = 0
        while at < len(reading) and at not in hesitant:
            ends = reading[at].bare == _CLAUSE_END
            at = quiet.get(at, at + 1 if ends else len(reading))
        return hesitant.get(at)

    @cached_property
    def _denying(self) -> frozenset[str]:
        """Words that alone deny what follows them, but for "no", which also answers."""
        return frozenset(row[0] for row in self._denials if len(row) == 2) - {_NO}

    @cached_property
    def _denials(self) -> frozenset[tuple[str, ...]]:
        rows = (_expanded(table, table.denials) for table in self._tables)
        return frozenset(_bare(phrase) for phrase, _ in chain.from_iterable(rows))

    @cached_property
    def _quiet(self) -> frozenset[tuple[str, ...]]:
        rows = (_phrases(table.courtesies) for table in self._tables)
        return frozenset(map(_bare, chain.from_iterable(rows)))

    def find(self, reading: Phrase) -> str | None:
        """The first stop word that counts."""
        bares = _bare(reading)
        for found in self._in(reading, self._anywhere):
            if not self._is_innocent(reading, bares, found):
                return found.word
        return self._glued(reading) or self._spelled(reading) or self._at_an_end(reading, bares)

    def _at_an_end(self, reading: Phrase, bares: tuple[str, ...]) -> str | None:
        """A stop word that counts only at the end of its clause, or only alone in it."""
        last, alone = [[*self._in(reading, table)] for table in (self._last, self._alone)]
        if not (last or alone):
            return None
        courtesies = self._in(reading, self._courtesies)
        quiet = _Quiet(reading, chain(courtesies, last, alone))
        ending = (one for one in last if quiet.after(one))
        lonely = (one for one in alone if quiet.after(one) and quiet.before(one))
        for found in chain(ending, lonely):
            if not self._is_innocent(reading, bares, found):
                return found.word
        return None

    def _glued(self, reading: Phrase) -> str | None:
        """A stop word repeated without spaces, as in "stopstopstop"."""
        for word in reading:
            for one in self._begun.get(word.bare[:2], ()):
                if _repeats(one, word.bare):
                    return self._whole[one]
        return None

    def _spelled(self, reading: Phrase) -> str | None:
        """A stop word spelled letter by letter, as in "s, t, o, p"."""
        for letters in spelled_out(reading):
            for bare, said in self._whole.items():
                if len(bare) >= _SPELLED_MIN and bare in letters:
                    return said
        return None

    def _in(self, reading: Phrase, index: "_Index") -> Iterator[_Found]:
        for start, word in enumerate(reading):
            for phrase, said in index.get(word.bare, ()):
                end = start + len(phrase)
                if end > len(reading) or reading[end - 1].bare != phrase[-1].bare:
                    continue
                if all(map(self._same, reading[start:end], phrase)):
                    yield _Found(said, start, end)

    def _same(self, word: SpelledWord, wanted: SpelledWord) -> bool:
        """True if both words fold to the same form, and `word` is no other word of the language."""
        return word.exact == wanted.exact or (
            word.bare == wanted.bare and word.exact not in self._others
        )

    def _is_innocent(self, reading: Phrase, bares: tuple[str, ...], found: _Found) -> bool:
        """True if the stop word is part of an innocent phrase within one clause."""
        excused = self._excused
        for start in range(max(0, found.end - excused.reach), found.start + 1):
            for length in excused.lengths.get(bares[start], ()):
                end = start + length
                if not found.end <= end <= len(reading):
                    continue
                phrases = excused.phrases.get(bares[start:end], ())
                said = reading[start:end] if phrases else ()
                if any(word.breaks for word in said[1:]):
                    break
                for phrase, must_end in phrases:
                    ends = not must_end or _ends_clause(reading, end)
                    if ends and all(map(self._same_innocent, said, phrase)):
                        return True
        return False

    def _same_innocent(self, word: SpelledWord, wanted: SpelledWord) -> bool:
        """Like `_same`, but `word` may be no other stop word: "dừng dừng" is not "đừng dừng"."""
        return self._same(word, wanted) and (
            word.exact == wanted.exact or word.exact not in self._exact
        )


class _Foreign:
    """Stop words of all other languages, which count only alone or first."""

    def __init__(self, code: str) -> None:
        known = {word.casefold() for word in (*STOP_WORDS[code].all, *STOP_WORDS[code].ordinary)}
        self._unspaced = code in _UNSPACED
        self._phrases: dict[str, list[tuple[Phrase, str]]] = defaultdict(list)
        for other in LANGUAGES:
            if other in (code, "en"):
                continue
            table = STOP_WORDS[other]
            for rows in (table.anywhere, table.last):
                for said, phrase in zip(rows, _phrases(rows), strict=True):
                    if said.casefold() not in known:
                        self._phrases[phrase[0].bare].append((phrase, said))

    def find(self, reading: Phrase) -> str | None:
        """The stop word at the beginning of this reading, or None."""
        for phrase, said in self._phrases.get(reading[0].bare, ()) if reading else ():
            end = len(phrase)
            if end > len(reading) or any(word.breaks for word in reading[1:end]):
                continue
            whole = not (self._unspaced or len(said) == 1) or _ends_clause(reading, end)
            if whole and all(map(_is_as_written, reading[:end], phrase)):
                return said
        return None


def _is_as_written(word: SpelledWord, wanted: SpelledWord) -> bool:
    """True if `word` is written as wanted; a long word may lack its accents."""
    return word.exact == wanted.exact or (word.bare == wanted.bare and len(word.bare) >= _ALONE_MIN)


def _without(table: StopWords, ordinary: Sequence[str]) -> StopWords:
    """A copy of another language's table without the ordinary words of the spoken language."""
    left = {
        name: tuple(one for one in getattr(table, name) if one not in ordinary)
        for name in ("anywhere", "last", "alone", "hesitant")
    }
    return replace(table, **left)


_Index = dict[str, list[tuple[Phrase, str]]]
_Innocent = dict[tuple[str, ...], list[tuple[Phrase, bool]]]


class _Excused:
    """Lookup tables for innocent phrases."""

    def __init__(self, phrases: _Innocent) -> None:
        self.phrases = phrases
        self.lengths = _lengths(phrases)
        self.reach = max(map(len, phrases))


@lru_cache
def _rules(code: str) -> _Rules:
    return _Rules(code)


@lru_cache
def _foreign(code: str) -> _Foreign:
    return _Foreign(code)


def _index(listed: Iterable[tuple[str, ...]]) -> _Index:
    """Phrases with their spelling in the table, keyed by the bare form of their first word."""
    index: _Index = defaultdict(list)
    for rows in listed:
        for said, phrase in zip(rows, _phrases(rows), strict=True):
            index[phrase[0].bare].append((phrase, said))
    return dict(index)


@lru_cache
def _phrases(rows: tuple[str, ...]) -> tuple[Phrase, ...]:
    return tuple(map(words, rows))


def _innocent(tables: Sequence[StopWords]) -> _Innocent:
    """Innocent phrases, each with whether it must end its clause, keyed by their bare words."""
    stops = {_bare(phrase) for table in tables for phrase in _phrases(table.all)}
    index: _Innocent = defaultdict(list)
    innocent = (_expanded(one, (*one.innocent, *one.denials)) for one in tables)
    for phrase, must_end in chain.from_iterable(innocent):
        bares = _bare(phrase)
        if bares not in stops:  # "ne {stop}" is none with "bouge plus"
            index[bares].append((phrase, must_end))
    return dict(index)


@lru_cache
def _expanded(table: StopWords, rows: tuple[str, ...]) -> tuple[tuple[Phrase, bool], ...]:
    """Phrases of a table with each stop word in their slot, and whether each ends its clause."""
    stops = (*_phrases(table.anywhere), *_phrases(table.last))
    found: list[tuple[Phrase, bool]] = []
    for row in rows:
        written = row.removesuffix(_CLAUSE_END)
        before, slot, after = written.partition("{stop}")
        begins, ends = words(before), words(after)
        said = stops if slot else ((),)
        found += [((*begins, *stop, *ends), written != row) for stop in said]
    return tuple(found)


def _lengths(phrases: Iterable[tuple[str, ...]]) -> dict[str, tuple[int, ...]]:
    """Lengths of the phrases in words, the shortest first, keyed by their first bare word."""
    lengths: dict[str, set[int]] = defaultdict(set)
    for phrase in phrases:
        lengths[phrase[0]].add(len(phrase))
    return {word: tuple(sorted(some)) for word, some in lengths.items()}


def _repeats(word: str, text: str) -> bool:
    """True if a bare text only repeats this word.

    Two repeats may share a letter if the word begins and ends with it.
    """
    more = word[1:] if word[0] == word[-1] else word
    times, rest = divmod(len(text) - len(word), len(more) or 1)
    return times > 0 and not rest and text == word + more * times


def _exact(phrase: Phrase) -> tuple[str, ...]:
    return tuple(word.exact for word in phrase)


def _bare(phrase: Phrase) -> tuple[str, ...]:
    return tuple(word.bare for word in phrase)


class _Quiet:
    """Tells whether only quiet words, such as courtesies, surround a word in its clause."""

    def __init__(self, reading: Phrase, said: Iterable[_Found]) -> None:
        quiet = {i for one in said for i in range(one.start, one.end)}
        self._reading = reading
        self._after = [True] * (len(reading) + 1)
        self._before = [True] * (len(reading) + 1)
        for i in reversed(range(len(reading))):
            self._after[i] = reading[i].breaks or (i in quiet and self._after[i + 1])
        for i, word in enumerate(reading):
            self._before[i + 1] = i in quiet and (word.breaks or self._before[i])

    def after(self, found: _Found) -> bool:
        """True if only quiet words stand between this word and the end of its clause."""
        return self._after[found.end]

    def before(self, found: _Found) -> bool:
        """True if only quiet words stand between the beginning of its clause and this word."""
        return self._reading[found.start].breaks or self._before[found.start]


def _ends_clause(reading: Phrase, end: int) -> bool:
    return end == len(reading) or reading[end].breaks


def _parts(text: str, code: str) -> Iterator[str]:
    """The text, or overlapping parts of one that is too long to search in full.

    Unicode folding may turn one character into eighteen, so the folded length decides. The parts
    at the beginning and the end come whole. Of the middle, only the surroundings of stop words come
    that are written as in the table.
    """
    if len(text) <= 2 * MAX_CHARACTERS:
        folded = one_form(text)
        if len(folded) <= 2 * MAX_CHARACTERS:
            yield text
            return
        text = folded
    begins = range(0, len(text), MAX_CHARACTERS)
    ends = (
        begins
        if len(begins) <= 2 * WHOLE_PARTS
        else (*begins[:WHOLE_PARTS], *begins[-WHOLE_PARTS:])
    )
    for begin in ends:
        yield text[max(0, begin - OVERLAP) : begin + MAX_CHARACTERS]
    if ends is not begins:
        yield from _near_stop_words(text[begins[WHOLE_PARTS] : begins[-WHOLE_PARTS]], code)


def _near_stop_words(text: str, code: str) -> Iterator[str]:
    """Each stop word with the text around it; from `MOST_FOUND` on the bare word, which stops."""
    folded = text.casefold()
    words = dict.fromkeys(said.casefold() for c in (code, "en") for said in STOP_WORDS[c].anywhere)
    for word in words:
        begin, count = folded.find(word), 0
        while begin >= 0:
            count += 1
            around = OVERLAP if count < MOST_FOUND else 0
            yield folded[max(0, begin - around) : begin + len(word) + around]
            if not around:
                break
            begin = folded.find(word, begin + len(word))
