"""The abilities of a robot in words, from its skills and without a model, and what it cannot do."""

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cache

from edgevox.agent.nlu.hearing.wordings import wordings
from edgevox.agent.nlu.lexicon import plain, words_of
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import MOST_SPOKEN, Phrasebook
from edgevox.agent.skills import STOP, Skill
from edgevox.agent.text.words import as_part, as_sentence


def abilities(book: Phrasebook, skills: Sequence[Skill]) -> tuple[str, str]:
    """A sentence with a few abilities, and one with the others if there are more.

    Abilities of this robot alone come first, and how to stop it comes last.
    """
    actions = [_can(book, one) for one in _telling(book, skills)]
    if not actions:
        return "", ""
    if len(actions) <= MOST_SPOKEN:
        return book.say("abilities", actions="; ".join(actions)), ""
    few, others = actions[: MOST_SPOKEN - 1], actions[MOST_SPOKEN - 1 :]
    said = book.say("abilities_more", actions="; ".join(few), count=len(others))
    return said, as_sentence("; ".join(others))


def not_understood(book: Phrasebook, skills: Sequence[Skill]) -> tuple[str, str]:
    """The sentence "not understood" with an example, and a detail to write.

    The detail has a few more examples and tells how to ask for all.
    """
    if not skills:
        return book.say("not_understood"), ""
    few, others = abilities(book, skills)
    if others:
        question = book.say("abilities_question")
        few = f"{few} {book.say('abilities_all', question=question)}"
    return book.say("not_understood_but", action=_can(book, _telling(book, skills)[0])), few


def _telling(book: Phrasebook, skills: Sequence[Skill]) -> Sequence[Skill]:
    return sorted(skills, key=lambda one: (book.knows(one), one.name == STOP))


def _can(book: Phrasebook, one: Skill) -> str:
    """The skill's ability in this language, or a sentence that asks for the skill.

    A skill without words in this language has only its description.
    """
    said = book.can(one)
    foreign = book.fallback is not None and said == as_part(one.description)
    return (foreign and _asked_for(book, one)) or said


def _asked_for(book: Phrasebook, one: Skill) -> str:
    sentence = next((each.sentence for each in wordings(one, book) if not each.alone), "")
    return book.say("quoted", words=sentence) if sentence else ""


_MARKS = re.compile(r"[,;.!?\u2026\u3001\u3002\u060c\u061b\u061f\u0964\uff0c\uff01\uff1f]+")
_ANY, _GAP = "*", "qzq"
"""The mark for any words, and letters in its place that no spelling changes."""


def cannot_do(
    text: str,
    book: Phrasebook,
    skills: Sequence[Skill],
    ordered: Callable[[], bool],
    no_act: Callable[[str, bool], bool],
) -> tuple[str, bool]:
    """The sentences that name what a text asks for and these skills cannot do; empty for none.

    "Go to the kitchen and bring me the mug" asks to carry something. In each clause the longest
    wording counts, where it begins; in a text that is `ordered` also behind other words, unless
    they deny. What a speaker plans to do counts only in its own wording. `no_act` tells of a
    clause, and of whether it opens with the wording, that it names no act after all.
    The second value is False for a text of one clause whose act is done where a thing is, so that
    a place in it is no place to go to: "pause the music in the kitchen".
    """
    names = {one.name for one in skills}
    acts, english = phrasebook(book.code).acts, phrasebook(ENGLISH).acts
    own = {word for one in skills if not book.knows(one) for word in _words_of(one, book)}
    found: dict[str, bool] = {}
    clauses = _clauses(text, book)
    courtesy = re.compile(_courtesies(book.code))
    for clause in clauses:
        if courtesy.fullmatch(clause):  # "take care"
            continue
        opens = True
        if _plans(clause, book):
            asked = _acts(clause, book.code)
        else:
            asked = [*_acts_in(clause, book.code)]
            opens = bool(asked)
            if not asked and (behind := _acts_behind(clause, book)) and ordered():
                asked = behind
        wording, name = max(asked, key=lambda one: len(one[0]), default=("", ""))
        if wording and not english[name].motion and no_act(clause, opens):
            continue
        if wording and names.isdisjoint(english[name].by) and not _words(wording) <= own:
            found[acts[name].cannot] = len(clauses) > 1 or not english[name].in_place
    return " ".join(found), any(found.values())


def _plans(clause: str, book: Phrasebook) -> bool:
    """True if a clause begins with what its speaker will do: "I need to open the door"."""
    return re.match(_planning(book.code), clause) is not None


@cache
def _planning(code: str) -> str:
    """A pattern of the words that open a plan of their speaker."""
    plans = [plain(one) for one in words_of(code).plans]
    return _whole(plans, spaced=phrasebook(code).hearing.spaced)


def _acts_behind(clause: str, book: Phrasebook) -> list[tuple[str, str]]:
    """The acts that an order names behind other words: "I am thirsty, Anna, fetch me a drink".

    A speaker who opens with a word for themself tells what they do: "I clean here now".
    """
    words, subject = clause.split(), _subject(book.code)
    if not book.hearing.spaced or re.search(_denials(book.code), clause):
        return []
    for at, before in enumerate(words[:-1], 1):
        tells = before in book.hearing.articles or (at == 1 and before == subject)
        found = [] if tells else _acts(" ".join(words[at:]), book.code)
        if found:
            return found
    return []


@cache
def _denials(code: str) -> str:
    """A pattern of the words that deny, in a language with spaces."""
    return _whole([plain(one) for one in words_of(code).negations], spaced=True)


def _words_of(one: Skill, book: Phrasebook) -> set[str]:
    """The words of a skill of a robot's own, which may do what others cannot."""
    sentences = (*book.templates(one), one.description, one.name.replace("_", " "))
    return {word for sentence in sentences for word in _words(sentence)}


def _words(sentence: str) -> set[str]:
    return {*re.findall(r"\w+", plain(sentence))}


def _clauses(text: str, book: Phrasebook) -> list[str]:
    """The parts of a text between its marks, its joints, and words that ask: "... can you ..."."""
    words = words_of(book.code)
    between = (*book.hearing.joints, *words.asking, *words.abilities)
    ordered = sorted({plain(one).strip() for one in between}, key=len, reverse=True)
    joint = _whole(ordered, spaced=book.hearing.spaced)
    clauses = [part for each in _MARKS.split(text) for part in re.split(joint, plain(each))]
    return [" ".join(one.split()) for one in clauses if one.strip()]


def _acts_in(clause: str, code: str) -> Iterator[tuple[str, str]]:
    """The acts that a clause asks for, each behind its wording."""
    small = _courtesies(code)
    while clause:
        found = _acts(clause, code)
        yield from found
        shorter = re.sub(rf"^\s*{small}\s*", "", clause, count=1)
        if shorter == clause:
            shorter = re.sub(rf"\s*{small}\s*$", "", clause, count=1)
        if found or shorter == clause:
            return
        clause = shorter


def _acts(clause: str, code: str) -> list[tuple[str, str]]:
    return [(said, name) for said, name, one in _wordings(code) if one.fullmatch(clause)]


@cache
def _wordings(code: str) -> list[tuple[str, str, re.Pattern[str]]]:
    """The wordings of the acts of a language, with their acts and patterns."""
    acts, spaced = phrasebook(code).acts.items(), phrasebook(code).hearing.spaced
    return [(one, name, _pattern(one, spaced=spaced)) for name, act in acts for one in act.words]


def _pattern(wording: str, *, spaced: bool) -> re.Pattern[str]:
    """The pattern of a clause with this wording, which may go on if it begins with a word."""
    written = " ".join(plain(wording.replace(_ANY, _GAP)).split())
    goes_on = not written.startswith(_GAP)
    words = re.escape(written).replace("\\ ", " ")
    if not spaced:
        return re.compile(words.replace(_GAP, ".*") + ".*" * goes_on)
    words = rf"{words}(?: .*)?" if goes_on else words.replace(f"{_GAP} ", "(?:.+ )?", 1)
    return re.compile(words.replace(f" {_GAP} ", " (?:.+ )?").replace(_GAP, r"\w*"))


@cache
def _courtesies(code: str) -> str:
    """A pattern of the small words that a clause may begin and end with.

    Articles are none of them: "my watch" is a thing, and asks nobody to watch. Nor is a word for
    the speaker: "I clean here now" asks nobody to clean.
    """
    words, answers = words_of(code), phrasebook(code).answers
    small = {*words.fillers, *words.asking, *words.abilities, *words.wishes, *answers.polite}
    no_courtesies = {*map(plain, phrasebook(code).hearing.articles), _subject(code)}
    plainly = {plain(one).strip() for one in small} - no_courtesies
    ordered = sorted(plainly, key=len, reverse=True)
    return _whole(ordered, spaced=phrasebook(code).hearing.spaced)


def _subject(code: str) -> str:
    """The word for the speaker as the one who does something: "I", not "me"."""
    return plain(words_of(code).me[0])


def _whole(phrases: Sequence[str], *, spaced: bool) -> str:
    """A pattern of these phrases, as whole words where there are words."""
    one = "|".join(map(re.escape, filter(None, phrases))) or "(?!)"
    return rf"(?<!\w)(?:{one})(?!\w)" if spaced else f"(?:{one})"
