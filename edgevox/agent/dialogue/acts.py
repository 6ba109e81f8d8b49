"""Answers: yes, no, and "no, the other one", in the words of a language."""

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from itertools import chain

from edgevox.agent.phrases.tables import AnswerWords
from edgevox.agent.text.spelling import NUMBER, key, separated, unpunctuated
from edgevox.core.files.text import one_form

MAX_TOKENS = 32
"""Number of tokens from which on a text is no answer."""

_MOST_DENYING = 6
"""Number of words, or of characters, of the longest denial that something follows."""

_MOST_CUTS = 36
"""Number of pairs of sentences that are tried for one with a choice."""

_CLAUSE_END = re.compile(
    r"[;!?\u061b\u061f\u0964\u2026\u3001\u3002\uff01\uff0c\uff1b\uff1f\u060c]+|[.,:](?!\d)"
)
_COMMA = re.compile(r"[,\u3001\u060c\uff0c]+(?!\d)")
_NUMBER = re.compile(NUMBER)
_TOKEN = re.compile(rf"{NUMBER}|[a-z']+|\S")
"""The tokens of a script without spaces: each character is one; foreign words stay whole."""


class Answer(StrEnum):
    """Answers to a yes-or-no question."""

    YES = "yes"
    NO = "no"


class _AnswerPart(StrEnum):
    """Kinds of phrases in an answer beside yes and no."""

    NOT = "not"
    DROP = "drop"
    POLITE = "polite"
    LITTLE = "little"
    AND = "and"
    INSTEAD = "instead"
    FIRST = "first"
    SECOND = "second"
    THIRD = "third"
    LAST = "last"


_ORDINALS = (_AnswerPart.FIRST, _AnswerPart.SECOND, _AnswerPart.THIRD, _AnswerPart.LAST)
_NONE = -1
"""Number of a choice that there is not: "the third" of two."""


@dataclass(frozen=True, slots=True)
class _Choice:
    """A word of one choice alone."""

    number: int


@dataclass(frozen=True, slots=True)
class _Value:
    """A spoken value: one of the words of an argument, or a number."""

    value: str


_Found = Answer | _AnswerPart | _Value | _Choice
_Phrases = Mapping[tuple[str, ...], _Found]
_Clause = tuple[_Found, ...]
_QUIET = frozenset({_AnswerPart.POLITE, _AnswerPart.LITTLE, _AnswerPart.INSTEAD, Answer.NO})
_DENYING = frozenset({_AnswerPart.NOT, _AnswerPart.DROP})


@dataclass(frozen=True, slots=True)
class Contrast:
    """A sentence that takes back one thing and wants another: "forget the kitchen, go home"."""

    denied: frozenset[str]
    """The words of arguments that are not wanted."""
    rest: str
    """The rest of the sentence."""
    joined: bool
    """True if the denial comes first and goes on with an "and", which may deny the rest as well."""
    plainly: bool
    """True if it cannot deny the rest: it comes last, a mark ends it, or it says "forget"."""


class Answers:
    """Reads answers in several languages at once.

    A text is an answer only if all of it is: "yes, but not now" is none. `spaced` is True for a
    language that puts spaces between words; `hesitant` words correct as well: "wait the office".
    `pairs` are the words for "and". `follows` is True for a language whose negations stand behind
    what they deny: "mutfak değil".
    """

    def __init__(
        self,
        tables: Iterable[AnswerWords],
        *,
        spaced: bool = True,
        hesitant: Iterable[str] = (),
        pairs: Iterable[str] = (),
        follows: bool = False,
    ) -> None:
        tables = tuple(tables)
        self._spaced = spaced
        self._not_follows = follows
        self._space = " " if spaced else ""
        nos = self._phrases(Answer.NO, chain.from_iterable(one.no for one in tables))
        nots = self._phrases(_AnswerPart.NOT, chain.from_iterable(one.not_ for one in tables))
        polite = self._phrases(
            _AnswerPart.POLITE, chain.from_iterable(one.polite for one in tables)
        )
        yes = self._phrases(Answer.YES, chain.from_iterable(one.yes for one in tables))
        drops = self._phrases(_AnswerPart.DROP, chain.from_iterable(one.drop for one in tables))
        little = self._phrases(
            _AnswerPart.LITTLE, chain.from_iterable(one.little for one in tables)
        )
        instead = self._phrases(
            _AnswerPart.INSTEAD, chain.from_iterable(one.instead for one in tables)
        )
        ordinals = {
            **self._phrases(_AnswerPart.FIRST, chain.from_iterable(one.first for one in tables)),
            **self._phrases(_AnswerPart.SECOND, chain.from_iterable(one.second for one in tables)),
            **self._phrases(_AnswerPart.THIRD, chain.from_iterable(one.third for one in tables)),
            **self._phrases(_AnswerPart.LAST, chain.from_iterable(one.last for one in tables)),
        }
        self._choosing = {**polite, **little, **instead, **ordinals}
        self._or = _joining(chain.from_iterable(one.or_ for one in tables), spaced=spaced)
        urging = chain.from_iterable(one.urging for one in tables)
        self._yes = {**polite, **self._phrases(_AnswerPart.POLITE, urging), **yes}
        self._no = {**polite, **nots, **nos}
        self._taking_back = {**polite, **instead, **nos}
        self._negating = {**self._taking_back, **nots}
        self._denials = {phrase[0] for phrase in chain(nos, nots)}
        self._takes_back = {word for phrase in instead for word in phrase} | self._denials
        waits = self._phrases(_AnswerPart.INSTEAD, hesitant)
        self._takes_back |= {word for phrase in waits for word in phrase}
        self._takes_back |= {phrase[0] for phrase in drops}
        pair = self._phrases(_AnswerPart.AND, pairs)
        self._dropping, self._nos, self._pairs = drops.keys(), nos.keys(), pair.keys()
        self._corrections = {
            **polite, **little, **pair, **waits, **instead, **nos, **nots, **drops
        }  # fmt: skip

    def read(self, text: str) -> Answer | None:
        """Yes or no if the text says nothing more, otherwise None."""
        for answer, phrases in ((Answer.NO, self._no), (Answer.YES, self._yes)):
            if {*chain.from_iterable(self._clauses(text, phrases))} - {_AnswerPart.POLITE}:
                return answer
        return None

    def after_no(self, text: str) -> str:
        """The text after a no and a comma or similar sign; empty unless it has both."""
        rest = ""
        for end in _CLAUSE_END.finditer(text):
            if self.read(text[: end.start()]) is not Answer.NO:
                break
            rest = text[end.end() :].strip()
        return rest

    def after_denial(self, text: str) -> str | None:
        """The text after a no at its beginning; None if it begins with none.

        Empty if there is nothing, or if the no may deny what stands behind it: "not the office".
        """
        if rest := self.after_no(text):
            return rest
        pieces, found = self._pieces(text), None
        for end in range(1, min(len(pieces), _MOST_DENYING) + 1):
            words = self._space.join(pieces[:end])
            if self.read(words) is Answer.NO:
                rest = self._space.join(pieces[end:])
                found = "" if self._also_negates(words) else rest
        return found

    def taken_back(self, text: str) -> Iterator[tuple[str, str, bool]]:
        """The text before and after words that take back what stands before them, the last first.

        "Go to the kitchen, no, the office". Where "no" also means "not", it counts only behind
        or before a mark. The third value is True if the words leave nothing of what was before.
        """
        pieces = self._pieces(text)
        for start in reversed(range(1, len(pieces))):
            if self._drops(pieces[start:]):  # "instead of": no "instead"
                continue
            ends = range(min(len(pieces), start + _MOST_DENYING), start, -1)
            said = ((end, self._space.join(pieces[start:end])) for end in ends)
            end = next((end for end, one in said if self._is_taking_back(one)), None)
            if end is None:
                continue
            before, words, after = map(
                self._space.join, (pieces[:start], pieces[start:end], pieces[end:])
            )
            parted = bool(_CLAUSE_END.match((words if after else before)[-1:]))
            if parted or not self._also_negates(words):
                denies = (parted or not after) and self.read(words) is Answer.NO
                yield before, after, denies

    def _drops(self, pieces: Sequence[str]) -> bool:
        words = _tokens(self._space.join(pieces), self._spaced)
        return any(words[: len(phrase)] == phrase for phrase in self._dropping)

    def _is_taking_back(self, text: str) -> bool:
        found = {*chain.from_iterable(self._clauses(text, self._taking_back))}
        return bool(found - {_AnswerPart.POLITE})

    def _also_negates(self, text: str) -> bool:
        """True if these words may deny the words behind them: "no al despacho"."""
        said = self._clauses(text, self._negating)
        return bool(said) and _AnswerPart.NOT in said[-1]

    def value(
        self, text: str, spoken: Mapping[str, str], meant: str, *, taken_back: bool = False
    ) -> str | None:
        """The word that a correction puts in place of `meant`; None if the text is no correction.

        `spoken` maps each spoken form to its word. "No, the office" and "not the kitchen, the
        office" mean the office; "not the office" does not. Where `meant` was `taken_back` before
        this text, "the office" is enough.
        """
        clauses = self._naming(text, spoken)
        said = {one.value for clause in clauses for one in _values(clause)}
        negated = {value for clause in clauses for value in self._negated(clause)}
        others = said - {meant} - negated
        denies = meant not in said and (taken_back or any(map(_says_no, clauses)))
        corrects = negated == {meant} if negated else denies
        return others.pop() if corrects and len(others) == 1 else None

    def denies(self, text: str, spoken: Mapping[str, str], meant: str) -> bool:
        """True if the text only says that `meant` is not wanted: "not the kitchen"."""
        clauses = self._naming(text, spoken)
        said = {one.value for clause in clauses for one in _values(clause)}
        negated = {value for clause in clauses for value in self._negated(clause)}
        return said == negated == {meant}

    def contrasts(self, text: str, spoken: Mapping[str, str]) -> Iterator[Contrast]:
        """Each way to part a text into words that deny something known, and a rest.

        The denial comes first or last: "not the kitchen, go home", "go home instead of there".
        """
        pieces = self._pieces(text)
        for at in range(1, len(pieces) if len(pieces) <= MAX_TOKENS else 0):
            first, last = self._space.join(pieces[:at]), self._space.join(pieces[at:])
            for denial, rest, leads in ((first, last, True), (last, first, False)):
                parted = any(map(_CLAUSE_END.fullmatch, (first[-1:], last.strip()[:1])))
                if one := self._denial(denial, spoken, parted=parted):
                    denied, drops, joined = one
                    # "Go home, no to the office" may mean "no, to the office".
                    plainly = drops or (
                        (parted or self._not_follows) if leads else not self._answers(denial)
                    )
                    wanted = _CLAUSE_END.sub("", rest[:1]) + rest[1:]
                    joined = leads and (joined or _tokens(rest, self._spaced)[:1] in self._pairs)
                    yield Contrast(denied, wanted.strip(), joined, plainly)

    def halves(self, text: str) -> Iterator[tuple[str, str, bool]]:
        """Each denial that a mark or an "instead of" may part from the rest, and that rest.

        The third value is True if the denial cannot be a "no" to what is before it.
        """
        pieces = self._pieces(text)
        for at in range(1, len(pieces) if len(pieces) <= MAX_TOKENS else 0):
            first, last = self._space.join(pieces[:at]), self._space.join(pieces[at:])
            if any(map(_CLAUSE_END.fullmatch, (first[-1:], last.strip()[:1]))):
                last = _CLAUSE_END.sub("", last.strip()[:1]) + last.strip()[1:]
                yield first, last, True
                if not self.after_no(last):
                    yield last, first, not self._answers(last)
            elif self._drops(pieces[at:]):
                yield last, first, True

    def _answers(self, text: str) -> bool:
        """True if a text begins with a word that is an answer as well: "no", "don't"."""
        words = _tokens(text, self._spaced)
        return any(words[:size] in self._nos for size in range(1, _MOST_DENYING))

    def _denial(
        self, text: str, spoken: Mapping[str, str], *, parted: bool
    ) -> tuple[frozenset[str], bool, bool] | None:
        """What a text denies, whether it drops it, and whether it ends with an "and".

        None for a text that says anything more.
        """
        clauses = [[p for p in one if p not in _QUIET] for one in self._naming(text, spoken)]
        said = [[p for p in one if p is not _AnswerPart.AND] for one in clauses]
        kinds = {part for one in said for part in one if part in _DENYING}
        if len(kinds) != 1 or not all(self._is_denial(one, parted=parted) for one in said if one):
            return None
        denied = frozenset(one.value for clause in said for one in _values(tuple(clause)))
        return denied, _AnswerPart.DROP in kinds, clauses[-1][-1:] == [_AnswerPart.AND]

    def _is_denial(self, clause: Sequence[_Found], *, parted: bool) -> bool:
        """True for a negation and what it denies, in the order of the language.

        Before a mark a negation may stand last as well: "die Küche nicht, ...".
        """
        names = [isinstance(part, _Value) for part in clause]
        leads = not self._not_follows and names == [False, *names[1:]] and all(names[1:])
        follows = (
            (self._not_follows or parted) and names == [*names[:-1], False] and all(names[:-1])
        )
        return len(names) > 1 and (leads or follows)

    def without_instead(self, text: str) -> str:
        """The text without an "instead" at its end."""
        pieces = self._pieces(text)
        ends = (
            (self._space.join(pieces[:at]), self._space.join(pieces[at:]))
            for at in range(1, len(pieces))
        )
        return next((rest for rest, end in ends if self._is_taking_back(end)), text)

    def named(self, text: str, spoken: Mapping[str, str]) -> frozenset[str]:
        """The words of arguments in a text that names them and denies nothing; else empty."""
        clauses = self._naming(text, spoken)
        denies = any(part in _DENYING or part is Answer.NO for one in clauses for part in one)
        return frozenset(one.value for clause in clauses if not denies for one in _values(clause))

    def _naming(self, text: str, spoken: Mapping[str, str]) -> Sequence[_Clause]:
        words: _Phrases = {
            form: _Value(word)
            for said, word in spoken.items()
            for form in _forms(said, self._spaced)
        }
        clauses = self._clauses(text, {**self._corrections, **words})
        # "Do not forget the kitchen" denies the opposite of what each of its words does.
        return () if any(_DENYING.issubset(one) for one in clauses) else clauses

    def _negated(self, clause: _Clause) -> set[str]:
        """The values that a clause denies, each beside its negation.

        Of two the language tells which: "not the kitchen", "mutfak değil".
        """
        plain = [part for part in clause if part is not _AnswerPart.POLITE]
        found = set()
        for at, part in enumerate(plain):
            if part in _DENYING or (part is Answer.NO and at > 0):
                before, after = _values(tuple(plain[:at])), _values(tuple(plain[at:]))
                beside = (
                    (before[-1:] or after[:1]) if self._not_follows else (after[:1] or before[-1:])
                )
                both = _AnswerPart.AND in plain[at:]
                found |= {one.value for one in (after if both and after else beside)}
        return found

    def numbers(self, text: str, *, taken_back: bool = False) -> tuple[str, ...]:
        """The numbers of a correction, as digits in their order; empty if it is no correction."""
        said: _Phrases = {(n,): _Value(n) for n in _NUMBER.findall(text)}
        clauses = self._clauses(text, {**self._corrections, **said})
        if any(map(self._negated, clauses)) or not (taken_back or any(map(_says_no, clauses))):
            return ()
        return tuple(one.value for clause in clauses for one in _values(clause))

    def may_correct(self, text: str) -> bool:
        """True if the text could take something back; a quick check, since most texts do not."""
        return not self._takes_back.isdisjoint(chain(*clause_tokens(text, self._spaced)))

    def alternatives(self, text: str) -> Iterator[tuple[str, ...]]:
        """Sentences to choose from, two or more; those that have the most in common come first.

        "Take the red or the green cube" stands for "take the red cube" and "take the green cube".
        Of several the last two are joined by an "or", and the others by that or by a comma.
        """
        joined = self._or.search(text)
        if joined is None:
            return
        two = (text[: joined.start()].rstrip(" ,"), text[joined.end() :])
        several = [part for one in self._or.split(text) for part in _COMMA.split(one)]
        for parts in (several, two) if len(several) > len(two) else (two,):
            yield from self._chosen_from([self._pieces(one) for one in parts if one.strip()])

    def _chosen_from(self, parts: Sequence[list[str]]) -> Iterator[tuple[str, ...]]:
        """Whole sentences: what stands before the first choice, each choice, and what follows."""
        if len(parts) < len(("one", "other")):
            return
        (before, *between, after) = parts
        cuts = itertools.product(range(1, len(before) + 1), range(1, len(after) + 1))
        for left, right in sorted(cuts, key=sum)[:_MOST_CUTS]:
            choices = (before[-left:], *between, after[:right])
            whole = ((*before[:-left], *one, *after[right:]) for one in choices)
            yield tuple(map(self._space.join, whole))

    def _pieces(self, text: str) -> list[str]:
        return text.split() if self._spaced else list(text.strip())

    def chosen(self, text: str, alternatives: Sequence[str]) -> int | None:
        """The index of the one of some sentences that a text chooses, or None.

        "The second", "the green one please" and "to the office" choose; "not the office" does not.
        """
        told = [{*chain.from_iterable(clause_tokens(one, self._spaced))} for one in alternatives]
        counts = Counter(chain.from_iterable(told))
        order: dict[_Found, int] = dict(zip(_ORDINALS[:-1], range(len(told)), strict=False))
        order[_AnswerPart.LAST] = len(told) - 1
        words: _Phrases = {
            (word,): _AnswerPart.LITTLE if counts[word] > 1 else _Choice(number)
            for number, one in enumerate(told)
            for word in one
        }
        said = chain.from_iterable(self._clauses(text, {**self._choosing, **words}))
        named = {
            one.number if isinstance(one, _Choice) else order.get(one, _NONE)
            for one in said
            if isinstance(one, _Choice) or one in _ORDINALS
        }
        return named.pop() if len(named) == 1 and _NONE not in named else None

    def _clauses(self, text: str, phrases: _Phrases) -> Sequence[_Clause]:
        """The phrases of each clause; empty if a clause holds anything else."""
        clauses = clause_tokens(text, self._spaced)
        if sum(map(len, clauses)) > MAX_TOKENS:
            return ()
        found = [_parts(tokens, phrases) for tokens in clauses]
        return found if all(found) else ()

    def _phrases(self, part: _Found, said: Iterable[str]) -> dict[tuple[str, ...], _Found]:
        return {form: part for one in said for form in _forms(one, self._spaced)}


def _joining(words: Iterable[str], *, spaced: bool) -> re.Pattern[str]:
    one = "|".join(map(re.escape, sorted(words, key=len, reverse=True))) or "(?!)"
    return re.compile(rf"(?<!\w)(?:{one})(?!\w)" if spaced else one, re.IGNORECASE)


@lru_cache(maxsize=4096)
def _forms(phrase: str, spaced: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Tokens of a phrase as it is written, and without the accents that people leave out."""
    return _tokens(phrase, spaced), _split(key(phrase), spaced)


@lru_cache(maxsize=16)
def clause_tokens(text: str, spaced: bool) -> tuple[tuple[str, ...], ...]:
    """The words of each clause that has any. Cached: a text is read several times."""
    clauses = (_tokens(part, spaced) for part in _CLAUSE_END.split(text))
    return tuple(tokens for tokens in clauses if tokens)


def _tokens(text: str, spaced: bool) -> tuple[str, ...]:
    """The words of a text with their accents, which may tell a yes from a no."""
    return _split(unpunctuated(separated(one_form(text)).casefold()), spaced)


def _split(text: str, spaced: bool) -> tuple[str, ...]:
    return tuple(text.split() if spaced else _TOKEN.findall(text))


def _parts(tokens: Sequence[str], phrases: _Phrases) -> _Clause:
    """Split tokens into known phrases, long ones first; empty if that is not possible.

    Works from the end: `rest[i]` holds the phrases of the tokens from `i` on.
    """
    rest: list[_Clause | None] = [None] * len(tokens) + [()]
    for start in reversed(range(len(tokens))):
        for end in range(len(tokens), start, -1):
            part, after = phrases.get(tuple(tokens[start:end])), rest[end]
            if part is not None and after is not None:
                rest[start] = (part, *after)
                break
    return rest[0] or ()


def clause_ends(text: str) -> list[int]:
    """Where clauses of a text end, behind their marks."""
    return [end.end() for end in _CLAUSE_END.finditer(text)]


def _values(clause: _Clause) -> list[_Value]:
    return [part for part in clause if isinstance(part, _Value)]


def _says_no(clause: _Clause) -> bool:
    """True if the clause takes back an earlier sentence, not its own words."""
    plain = [part for part in clause if part is not _AnswerPart.POLITE]
    alone = not _values(clause) and not {Answer.NO, *_DENYING}.isdisjoint(plain)
    instead = _AnswerPart.INSTEAD in (*plain[:1], *plain[-1:])
    return bool(plain) and (alone or instead or plain[0] is Answer.NO)
