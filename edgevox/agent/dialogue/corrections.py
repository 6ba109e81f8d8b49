"""Corrections: what words mean that take something back, in a sentence or in the one before.

"No, the bedroom", "to the kitchen, no, the office", "forget the kitchen, go to the office".
A correction changes a call: "no, to the office" is the same call with another value of one
argument.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from edgevox.agent.agents import Agent
from edgevox.agent.dialogue.acts import Answers, Contrast, clause_ends, clause_tokens
from edgevox.agent.dialogue.memory import LastDrive
from edgevox.agent.dialogue.question import OpenQuestion
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.lexicon import words_of
from edgevox.agent.nlu.meaning import ASK_FROM, IT, THE_OTHER, Meaning
from edgevox.agent.nlu.templates import RefusedCommand
from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, OneOf, Skill
from edgevox.agent.skills.skill import opposite_of
from edgevox.agent.stop.words import denies_stop
from edgevox.agent.text.spelling import NUMBER, is_same_name, key
from edgevox.core.files.text import one_form
from edgevox.core.files.validation import is_number
from edgevox.core.languages import STOP_WORDS

_MOST_NAME_WORDS = 3
"""Number of words of the longest name that is found in another form."""

_AMOUNT = re.compile(rf"(?P<number>{NUMBER})(?P<behind>\s*[^\W\d]*)")
"""A number, and the word behind it."""

_First = tuple[Agent, Sequence[Call], Call]
"""What a correction changes: an agent, its calls, and the one of them that drives."""


@dataclass(frozen=True, slots=True)
class Instead:
    """What a sentence wants in place of what it takes back."""

    meaning: Meaning | RefusedCommand | None
    """What it wants; None if that is no plain command."""
    rest: str
    """The words that want it."""
    ends: bool
    """True if it takes back what the robot last set out to do, or was asked about."""
    keeps: bool = False
    """True if it only wants just that: "the kitchen, not the office" on the way to the kitchen."""


class Corrections:
    """Reads corrections, in the interpreter's language.

    Any thread may ask for `of`, `bare` and `denies`, only the conversation's for the others.

    A correction changes the open question, otherwise the last drive.
    """

    def __init__(self, interpreter: Interpreter, question: OpenQuestion, last: LastDrive) -> None:
        self._interpreter = interpreter
        self._question = question
        self._last = last
        self.set_language()

    def set_language(self) -> None:
        """Read in the interpreter's language from now on."""
        self.answers = _answers(self._interpreter.phrases)

    def of(self, text: str) -> Meaning | None:
        """What a correction of the open question or of the last drive means, or None."""
        first = self._first()
        return self._changed(text, first, taken_back=False) if first else None

    def bare(self, text: str) -> Meaning | None:
        """What "the office" alone means, while a drive to the kitchen is asked about: unsure."""
        asked = self._question.asked
        first = _one_drive(asked.meaning) if asked and not asked.others else None
        if first is None or self._interpreter.plain(text) is not None:
            return None
        changed = self._changed(text, first)
        return replace(changed, confidence=ASK_FROM) if changed else None

    def denies(self, text: str) -> bool:
        """True for "not the kitchen", while that is asked about or on the way there."""
        first = self._first()
        if first is None:
            return False
        agent, _, call = first
        return denies(call, agent.every_skill[call.skill], text, self.answers, self._book)

    def instead(self, text: str) -> Instead | None:
        """What a sentence wants that denies something besides, or None for any other sentence."""
        if not (self.answers.may_correct(text) or clause_ends(text)):
            return None
        skills = self._interpreter.active.every_skill.values()
        plain = digits(" ".join(one_form(text).split()), self._book.code)
        numbers = self._numbers(plain)
        spoken = {**known_words(skills, self._book, text), **numbers}
        found = [
            *self.answers.contrasts(plain if numbers else text, spoken),
            *self._not_stopping(text),
            *self._other_ways(text),
        ]
        first = self._first()
        meant = {first[2].skill, *map(str, first[2].arguments.values())} if first else set[str]()
        for one in found:
            if one.denied & {*numbers.values()} and not any(map(str.isdigit, one.rest)):
                continue  # the amount that is not wanted was said, and none in its place
            if (read := self._wanted(one)) is not None:
                return Instead(read, one.rest, bool(meant & one.denied))
        for one in found:
            named = self.answers.named(one.rest, spoken)
            if len(named) == 1 and not one.joined and not named & one.denied:
                return Instead(None, one.rest, bool(meant & one.denied), keeps=named <= meant)
        ends = next((one for one in found if meant & one.denied), None)
        return Instead(None, "" if ends.joined else ends.rest, ends=True) if ends else None

    def _wanted(self, one: Contrast) -> Meaning | RefusedCommand | None:
        """The plain command beside a denial; None if the denial may be one of it as well."""
        if one.joined and not one.plainly:
            return None
        rest = self.answers.without_instead(one.rest)
        read, other = self._interpreter.plain(one.rest), self._interpreter.plain(rest)
        read = read if isinstance(read, Meaning) else other
        if read is None and one.denied & self._interpreter.active.every_skill.keys():
            read = self._interpreter.named(rest)
        if not isinstance(read, Meaning):
            return read
        values = {str(value) for call in read.calls for value in call.arguments.values()}
        values |= {call.skill for call in read.calls}
        skills = read.agent.every_skill
        if values & one.denied or any(skills[call.skill].lasting for call in read.calls):
            return None
        return read if one.plainly else replace(read, confidence=min(read.confidence, ASK_FROM))

    def _not_stopping(self, text: str) -> Iterator[Contrast]:
        """The rest of "don't stop, go to the office"."""
        for end in clause_ends(text):
            first, last = text[:end].strip(), text[end:].strip()
            for denial, rest in ((first, last), (last, first)):
                if rest and denies_stop(self._book.code, denial):
                    yield Contrast(frozenset(), rest, joined=False, plainly=True)

    def _numbers(self, text: str) -> Mapping[str, str]:
        """What may be said for the numbers of a text, with and without their units."""
        amounts = words_of(self._book.code).amounts
        said = {}
        for one in _AMOUNT.finditer(text):
            value = str(float(one["number"]))
            said[one["number"]] = value
            for unit in amounts:
                if one["behind"].lstrip().startswith(unit):
                    said[f"{one['number']} {unit}"] = said[f"{one['number']}{unit}"] = value
        return said

    def _other_ways(self, text: str) -> Iterator[Contrast]:
        """The rest of "don't turn left, turn right", if it is a motion by an amount as well."""
        if isinstance(self.taken_back(text), Meaning):  # "turn left, no, to the right"
            return
        for denial, rest, plainly in self.answers.halves(text):
            wanted = self._interpreter.named(rest)
            if not wanted or len(wanted.calls) != 1:
                continue
            skills = wanted.agent.every_skill
            denied = self._interpreter.denied(denial)
            if denied and skills[wanted.calls[0].skill].relative and skills[denied.skill].relative:
                yield Contrast(frozenset({denied.skill}), rest, joined=False, plainly=plainly)

    def taken_back(self, text: str) -> Meaning | bool:
        """What a sentence means that takes back its own beginning: "the kitchen, no, the office".

        True if only the beginning can be meant, which nothing is left of; False for any other text.
        """
        if isinstance(self._interpreter.plain(text), Meaning):
            return False
        for before, after, is_no in self.answers.taken_back(text):
            plain = self._interpreter.plain(before)
            meant = plain if isinstance(plain, Meaning) else self.taken_back(before)
            first = _one_drive(meant) if isinstance(meant, Meaning) else None
            if first is None:
                continue
            right = self._changed(after, first, named=True) or self._interpreter.plain(after)
            if isinstance(right, Meaning):
                return right
            if is_no:
                return True
        return False

    def after_stop(self, text: str, before: str) -> Meaning | RefusedCommand | None:
        """What a person wants in place of what was stopped, or of the words `before`."""
        for ordered, rest, _ in self.answers.taken_back(before):
            before = before if rest else ordered  # "go to the kitchen, no"
        plain = self._interpreter.plain(before) if before else None
        first = _one_drive(plain) if isinstance(plain, Meaning) else self._last_drive()
        meant = self._changed(text, first, named=True) if first else None
        return meant or self._interpreter.plain(self.answers.after_denial(text) or text)

    def _changed(
        self, text: str, first: _First, *, taken_back: bool = True, named: bool = False
    ) -> Meaning | None:
        """The calls with another one in place of the drive that the text corrects.

        With `taken_back`, words before the text took it back. With `named`, it is enough that the
        text names another way: only the conversation's thread may ask for that.
        """
        agent, calls, wrong = first
        skill = agent.every_skill[wrong.skill]
        right = correct(wrong, skill, text, self.answers, self._book, taken_back=taken_back)
        rest = text if taken_back else self.answers.after_no(text)
        right = right or (self._other_way(wrong, agent, rest, named=named) if rest else None)
        if right is None:
            return None
        return Meaning(agent, tuple(right if c is wrong else c for c in calls), "template")

    def _other_way(self, wrong: Call, agent: Agent, text: str, *, named: bool) -> Call | None:
        """The call by the same amount the other way: "no, to the right"."""
        said = self._interpreter.named(text) if named else self._interpreter.plain(text)
        if not isinstance(said, Meaning) or len(said.calls) != 1:
            return None
        (call,) = said.calls
        skills = agent.every_skill
        if call.skill == THE_OTHER and self._question.asked:
            return opposite_of(wrong, skills)
        if call.skill == wrong.skill or call.arguments or call.skill not in skills:
            return None
        one, other = skills[call.skill], skills[wrong.skill]
        same = one.arguments_model.model_fields.keys() == other.arguments_model.model_fields.keys()
        return (
            Call(call.skill, wrong.arguments) if one.relative and other.relative and same else None
        )

    def _first(self) -> _First | None:
        asked = self._question.asked
        return _one_drive(asked.meaning) if asked else self._last_drive()

    def _last_drive(self) -> _First | None:
        drive = self._last.corrigible
        return (drive.agent, (drive.call,), drive.call) if drive else None

    @property
    def _book(self) -> Phrasebook:
        return self._interpreter.phrases


def _one_drive(meaning: Meaning) -> _First | None:
    """What could be corrected in a meaning; None if not just one of its calls drives."""
    skills = meaning.agent.every_skill
    driving = [call for call in meaning.calls if skills[call.skill].drives]
    return (meaning.agent, meaning.calls, driving[0]) if len(driving) == 1 else None


def _answers(book: Phrasebook) -> Answers:
    books = (book, book.fallback) if book.fallback else (book,)
    hesitant = [word for one in books for word in STOP_WORDS[one.code].hesitant]
    return Answers(
        [one.answers for one in books],
        spaced=book.hearing.spaced,
        hesitant=hesitant,
        pairs=[one.hearing.pair for one in books],
        follows=book.hearing.denials_follow,
    )


def correct(
    call: Call,
    one: Skill,
    text: str,
    answers: Answers,
    book: Phrasebook,
    *,
    taken_back: bool = False,
) -> Call | None:
    """The corrected call; None unless the text is a correction without doubt.

    A word counts if the skill's templates know it for the argument in this language. Numbers
    replace all numbers of the call, so there must be as many. `taken_back` says that words before
    the text took the call back.
    """
    if not (taken_back or answers.may_correct(text)) or not is_exact(text, book.code):
        return None
    found = [*_words(call, one, text, answers, book, taken_back=taken_back)]
    if len(found) == 1:
        return Call(call.skill, {**call.arguments, **found[0]})
    if found:
        return None
    names = [name for name, value in call.arguments.items() if is_number(value)]
    plain = digits(" ".join(one_form(text).split()), book.code)
    said = answers.numbers(plain, taken_back=taken_back)
    if not names or len(names) != len(said):
        return None
    changed = one.from_words(dict(zip(names, said, strict=True)))
    return Call(call.skill, {**call.arguments, **changed})


def denies(call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook) -> bool:
    """True if the text only says that a value of the call is not wanted: "not the kitchen"."""
    if not answers.may_correct(text):
        return False
    spoken = ((name, _heard(choices, book, text)) for name, choices in one.choices.items())
    return any(answers.denies(text, said, str(call.arguments.get(name))) for name, said in spoken)


def _words(
    call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook, *, taken_back: bool
) -> list[Mapping[str, Any]]:
    """Each argument that the text could correct, with its new value."""
    found: list[Mapping[str, Any]] = []
    for name, choices in one.choices.items():
        spoken = _heard(choices, book, text)
        meant = str(call.arguments.get(name))
        value = answers.value(text, spoken, meant, taken_back=taken_back)
        found += [{name: value}] if value else []
    return found


def known_words(skills: Iterable[Skill], book: Phrasebook, text: str) -> Mapping[str, str]:
    """What may be said for the words of the arguments of these skills, as `text` may say it."""
    known = (choices for one in skills for choices in one.choices.values())
    return {said: word for one in known for said, word in _heard(one, book, text).items()}


def _heard(choices: OneOf, book: Phrasebook, text: str) -> Mapping[str, str]:
    """Each spoken form of a word, and each inflected one in the text: "вместо кухни"."""
    spoken = {said: word for said, word in book.heard(choices).items() if word != IT}
    if not book.fallback or not book.hearing.spaced:
        return spoken
    keys = {key(said): word for said, word in spoken.items()}
    found = dict(spoken)
    small = frozenset(map(key, (*book.answers.little, *book.answers.polite, book.hearing.pair)))
    for said in _windows(text, small):
        plain = key(said)
        meant = {word for one, word in keys.items() if is_same_name(plain, one, inflected=True)}
        if plain not in keys and len(meant) == 1:
            found[said] = meant.pop()
    return found


def _windows(text: str, small: frozenset[str]) -> Iterator[str]:
    """Each row of a few words of one clause, without small ones at its ends."""
    for tokens in clause_tokens(text, spaced=True):
        for size in range(1, _MOST_NAME_WORDS + 1):
            for start in range(len(tokens) - size + 1):
                row = tokens[start : start + size]
                if small.isdisjoint(map(key, (row[0], row[-1]))):
                    yield " ".join(row)
