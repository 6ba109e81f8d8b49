"""Questions to the robot: what is asked, and what a language model may answer.

A model knows nothing of the robot and its world. A question about them that no fact answers gets
"I do not know that", and no sentence of a model passes that speaks of the robot itself.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, cached_property

from edgevox.agent.nlu.clauses import Name, find_names
from edgevox.agent.nlu.evidence import QUESTION_MARKS
from edgevox.agent.nlu.judging import Judged
from edgevox.agent.nlu.lexicon import TOKEN, Lexicon, Words, is_mark, plain, words_of
from edgevox.agent.nlu.meaning import IT
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill
from edgevox.agent.text.spelling import NUMBER, key
from edgevox.agent.text.words import spoken_name
from edgevox.core.languages import LANGUAGES

_LEAST_SAID = 0.4
"""Least weight of a word for the question that the encoder takes a text for."""
_LEAST_TOLD = 4.0, 2.8
"""Least weight of the words for a question that names nothing of the robot's world, and for one
that does."""
_LEAST_LEAD = 2.0, 1.0
"""Least lead in weight over another question, for either."""
LIKELY_TOLD, PLAINLY_TOLD = 0.6, 0.9
"""Least likelihood of a question to the robot, by the encoder alone, and of one in any words."""
MOST_STRANGE = 0.17, 0.25
"""Largest share of unknown words in either: "how fast is light" is no question to the robot."""
_MOST_STRANGE_SIGNS = 0.5
"""The same where words are not written apart: each sign of an unknown word counts."""


def question_of(judged: Judged | None, text: str, code: str) -> Call | None:
    """The one thing that a sentence asks, of skills that only tell; None if that is not clear.

    It needs no encoder: an answer moves nothing, so the words of the questions are enough.
    """
    if judged is None or len(judged.reading.parts) != 1 or not asks(text, code):
        return None
    (part,), facts = judged.reading.parts, judged.evidence
    named = part.grounded > 0
    told = part.support >= _LEAST_TOLD[named]
    known = facts["share_strange"] <= MOST_STRANGE[named] and not facts["strange_unfilled"]
    clear = part.support - part.rival >= _LEAST_LEAD[named] and not facts["denied"]
    return part.call if told and known and clear else None


def question_about(kind: str, text: str, lexicon: Lexicon, *, plainly: bool = False) -> Call | None:
    """The question of this kind, a skill that tells something, with the names in a text.

    None if a name is missing, or one is no value of it. Unless it is `plainly` of this kind, also
    None for one of the speaker alone ("what is my name"), and for a text that asks nothing or has
    no word of such a question.
    """
    one, code = lexicon.skills.get(kind), lexicon.book.code
    asking = plainly or asks(text, code) or _opens_a_clause(text, words_of(code).talking, code)
    if one is None or not asking:
        return None
    words = words_of(code)
    if not plainly and _holds(text, words.me, code) and not _holds(text, words.you, code):
        return None
    tokens = lexicon.tokenize(digits(" ".join(text.split()), code))
    names, weights = find_names(lexicon, tokens), lexicon.words[kind].weights
    used = all(any(skill == kind for skill, _ in name.values) for name in names)
    small = lexicon.index(words.all()).places(tokens)
    said = (
        plainly
        or names
        or any(
            weights.get(word, 0.0) >= _LEAST_SAID
            for at, word in enumerate(tokens)
            if at not in small
        )
    )
    return _call(one, names) if used and said else None


def cued(text: str, lexicon: Lexicon, general: Callable[[], bool] = lambda: False) -> Call | None:
    """The question of the table `cues` whose words are all said, in any order; None if unclear.

    Of several questions the one with the most groups of words is asked, then the one with the
    longest. All names must be used, and hardly a word be unknown: "how long does a film last";
    none at all in a text that asks of the world in `general`: "in which year did the war end".
    """
    if not _inquires(text, lexicon.book.code):
        return None
    written = lexicon.tokenize(digits(" ".join(text.split()), lexicon.book.code))
    most = MOST_STRANGE[0] if lexicon.book.hearing.spaced else _MOST_STRANGE_SIGNS
    for tokens in dict.fromkeys((written, lexicon.spelled(written))):
        if call := _cued(tokens, lexicon, most):
            return _cued(tokens, lexicon, 0.0) if general() else call
    return None


def _cued(tokens: Words, lexicon: Lexicon, most: float) -> Call | None:
    names, asked = find_names(lexicon, tokens), dict[tuple[int, int], list[Call]]()
    for one in lexicon.skills.values():
        cues = _cues(one, lexicon.book)
        used = _used(tokens, cues, lexicon.book.code)
        uncovered = [name for name in names if not _covers(used, tokens[name.start : name.end])]
        for groups, slots in cues:
            called = names if slots == len(names) else uncovered
            said = _joined(_with_slots(tokens, called if slots else ()), lexicon.book.code)
            found = [hit[0].strip() for group in groups if (hit := group.search(said))]
            call = _call(one, called if slots else ())
            if len(found) < len(groups) or len(called) != slots or call is None:
                continue
            if _share_strange(tokens, used, called, lexicon) <= most:
                asked.setdefault((len(found), sum(map(len, found))), []).append(call)
    first, *others = asked[max(asked)] if asked else [None]
    return first if all(one == first for one in others) else None


def _cues(one: Skill, book: Phrasebook) -> list[tuple[tuple[re.Pattern[str], ...], int]]:
    """The cues of a question, each with the number of its slots."""
    cues = book.cues.get(one.entry) or book.cues.get(one.name, ())
    return [(_groups(book.written_out(cue), book.code), len(_SLOT.findall(cue))) for cue in cues]


def _inquires(text: str, code: str) -> bool:
    """True if the text has a question mark or a question word that asks, and opens as no wish."""
    words, said = words_of(code), f"{plain(text)} "
    if any(said.startswith(f"{plain(one)} ") for one in words.wishes):
        return False
    if any(mark in text for mark in QUESTION_MARKS):
        return True
    anywhere = [one for one in words.questions if one not in words.inverted]
    return _holds(text, anywhere, code) or _opens_a_clause(text, words.inverted, code)


def _opens_a_clause(text: str, phrases: Iterable[str], code: str) -> bool:
    """True if one of these phrases opens a clause, courtesies aside."""
    small = {key(one) for one in phrasebook(code).answers.polite}
    for clause in _MARKS.split(text):
        said = key(clause).split()
        while said and said[0] in small:
            said.pop(0)
        if any(f"{' '.join(said)} ".startswith(f"{key(one)} ") for one in phrases):
            return True
    return False


def _joined(tokens: Iterable[str], code: str) -> str:
    space = " " if LANGUAGES[code].spaced else ""
    return f"{space}{space.join(tokens)}{space}"


def _with_slots(tokens: Words, names: Sequence[Name]) -> Iterator[str]:
    """The tokens, with a slot for each name: "how far is the {room}"."""
    starts = {one.start: one for one in names}
    inside = {at for one in names for at in range(one.start, one.end)}
    for at, token in enumerate(tokens):
        if at in starts:
            yield from {f"{{{spoken_name(argument)}}}" for _, argument in starts[at].values}
        elif at not in inside:
            yield token


@cache
def _groups(cue: str, code: str) -> tuple[re.Pattern[str], ...]:
    """The pattern of each group of words of a cue; `*` stands for any ending of a word."""
    groups = [(several or single).split("|") for several, single in _GROUP.findall(cue)]
    return tuple(re.compile("|".join(_form(one, code) for one in forms)) for forms in groups)


def _form(form: str, code: str) -> str:
    if form.startswith("{"):
        return re.escape(form)
    tokens = TOKEN.findall(plain(digits(form.removesuffix("*"), code)))
    words = re.escape(_joined(tokens, code).strip())
    if not LANGUAGES[code].spaced:
        return words
    ending = r"\w*" if form.endswith("*") else ""
    return rf"(?<= ){words}{ending}(?=[ '])"


def _used(
    tokens: Words, cues: Iterable[tuple[Iterable[re.Pattern[str]], int]], code: str
) -> frozenset[str]:
    """The words of the sentence that some cue of a question has."""
    said = _joined(tokens, code)
    groups = {group for several, _ in cues for group in several}
    found = (hit[0] for group in groups for hit in group.finditer(said))
    return frozenset(word for one in found for word in one.split())


def _covers(used: frozenset[str], name: Words) -> bool:
    """True if a name is made of these words: "left" is a bin, and a word of "how many are left"."""
    return used.issuperset(name) or any("".join(name) in one for one in used)


def _share_strange(
    tokens: Words, used: frozenset[str], names: Sequence[Name], lexicon: Lexicon
) -> float:
    """The share of unknown words, beside the names and the words of this question's cues."""
    inside = {at for one in names for at in range(one.start, one.end)}
    strange = [
        one
        for at, one in enumerate(tokens)
        if at not in inside and not (is_mark(one) or lexicon.knows(one) or one in used)
    ]
    return len(strange) / max(1, len(tokens))


def _call(one: Skill, names: Sequence[Name]) -> Call | None:
    """The call of this skill with these names; None if one is missing."""
    said = {
        argument: word
        for name in names
        for (skill, argument), word in name.values.items()
        if skill == one.name
    }
    fields = one.arguments_model.model_fields
    lacks = any(info.is_required() and name not in said for name, info in fields.items())
    return None if lacks else Call(one.name, said)


_MARKS = re.compile(r"[,;.!:]")
_SENTENCES = re.compile(r"(?<=[.!\u2026])\s+(?=\S)|(?<=[\u3002\uff01\u0964])(?=.)")
_GROUP = re.compile(r"\(([^()]*)\)|([^\s()]+)")
_SLOT = re.compile(r"\{\w+\}")


def asks(text: str, code: str) -> bool:
    """True if the text has a question mark or begins with a question word, and asks for no act.

    "Honey, can you get me some water?" asks for one: small words may stand before that, and so may
    sentences that ask nothing: "Clever. Would you ...".
    """
    *before, last = _SENTENCES.split(text.strip())
    return _asks(text if any(_asks(one, code) for one in before) else last, code)


def _asks(text: str, code: str) -> bool:
    words, said = words_of(code), f"{plain(text)} "
    wishes = (*words.asking, *words.abilities, *words.wishes)
    addressed = f"{plain(_without_address(text, code))} "
    if any(one.startswith(f"{plain(wish)} ") for wish in wishes for one in (said, addressed)):
        return False
    marked = any(mark in text for mark in QUESTION_MARKS)
    return marked or any(said.startswith(f"{plain(one)} ") for one in words.questions)


def _without_address(text: str, code: str) -> str:
    """The text without small words that a mark parts from what follows: "honey, ..."."""
    small = {key(one) for one in words_of(code).fillers}
    first, *rest = re.split(r"[,\uff0c\u3001\u060c]", text, maxsplit=1)
    return rest[0].strip() if rest and key(first).strip() in small else text


def asks_whether(text: str, code: str) -> bool:
    """True if the words ask about an ability other than to talk: "can you fly".

    "How many hours can you run" asks how many.
    """
    words = words_of(code)
    said = f" {plain(text)} "
    asked = [plain(one) for one in words.abilities if plain(one) in said]
    first = [one for one in map(plain, words.questions) if said.startswith(f" {one} ")]
    if first and not any(said.startswith(f" {one} ") for one in asked):
        return False
    for one in asked:
        said = said.replace(one, " ")
    return bool(asked) and not _holds(said, words.talking, code)


def is_about_hearer(text: str, code: str) -> bool:
    """True if the words speak of the hearer, other than to ask politely: "how old are you"."""
    words = words_of(code)
    said = f" {plain(text)} "
    for one in sorted((*words.asking, *words.abilities, *words.talking), key=len, reverse=True):
        said = said.replace(plain(one), " ")
    return _holds(said, words.you, code)


def _holds(text: str, phrases: Iterable[str], code: str) -> bool:
    """True if one of these phrases stands in the text; as whole words, where there are words."""
    spaced = LANGUAGES[code].spaced
    said = f" {key(text)} "
    return any((f" {key(one)} " if spaced else key(one)) in said for one in phrases)


class WorldWords:
    """The words for the things and places of some skills' arguments, as at its first use."""

    def __init__(self, skills: Iterable[Skill], book: Phrasebook) -> None:
        self._skills = tuple(skills)
        self._book = book

    def named_in(self, text: str) -> bool:
        """True if the text names a thing or a place of the robot's world."""
        return _holds(text, self._forms, self._book.code)

    def claims_for_itself(self, sentence: str) -> bool:
        """True if the sentence speaks of its speaker: "I have locked the door"."""
        me = (*words_of(self._book.code).me, *words_of(ENGLISH).me, PRODUCT)
        return _holds(re.sub(r"['\u2019]", " ", sentence), me, self._book.code)

    def claimed_in(self, sentence: str) -> bool:
        """True if the sentence names such a thing, or a number."""
        numbers = _NUMBER.findall(digits(sentence, self._book.code))
        return any(float(one) != 1 for one in numbers) or self.named_in(sentence)

    @cached_property
    def _forms(self) -> frozenset[str]:
        """All names, without those that are only a part of another: "red" of "red cube"."""
        known = {
            key(form): word
            for one in self._skills
            for choices in one.choices.values()
            for form, word in self._book.heard(choices).items()
            if word != IT
        }
        parts = {part for form in known if " " in form for part in form.split()}
        return frozenset(known.keys() - (parts - {key(word) for word in known.values()}))


PRODUCT = "EdgeVox"
_NUMBER = re.compile(NUMBER)
