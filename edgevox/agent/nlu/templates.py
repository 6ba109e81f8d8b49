"""Plain commands understood in milliseconds, by sentence templates that belong to the skills."""

import difflib
import re
import threading
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hassil import RecognizeResult, recognize_all
from hassil.intents import TextSlotList

from edgevox.agent.arguments import is_number_type
from edgevox.agent.nlu.template_compiler import (
    Templates,
    compile_templates,
    word_list,
    written,
)
from edgevox.agent.numbers import digits, is_exact
from edgevox.agent.own_names import phrasebook_of
from edgevox.agent.phrase_file import ENGLISH
from edgevox.agent.phrase_hearing import Hearing
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import NO_SKILLS, Call, Skill, SkillSet
from edgevox.agent.spelling import (
    ENDING,
    NUMBER,
    folded,
    is_same_name,
    key,
    separated,
    unpunctuated,
)
from edgevox.agent.spoken_lists import brief, whole
from edgevox.core.text import one_form

MAX_CHARACTERS = 240
"""Longer utterances are not plain commands; they go to the model."""

_NUMBER = re.compile(NUMBER)
_PAIR = re.compile(rf"({NUMBER})\s*,?\s+(?={NUMBER}(?:[\s,]|\W*$))")
_NOTHING = "nothingatall"
_NEAR, _WORD_NEAR = 0.8, 0.6
"""How alike a misheard name is to a known one as a whole, and each of its words."""
_MAX_UNKNOWN_WORDS = 3
_MAX_UNKNOWN_CHARACTERS = 8
"""The longest unknown name where words have no spaces between them."""


@dataclass(frozen=True, slots=True)
class Understood:
    """The utterance is these calls; `nearly`: a word of it is only like the one that it became."""

    calls: tuple[Call, ...]
    nearly: bool = False


@dataclass(frozen=True, slots=True)
class RefusedCommand:
    """A plain command in which a word is missing or unknown; `reason` says which.

    `detail` is the whole list of what is known, where that is too long to be spoken.
    """

    reason: str
    detail: str = ""


class Recogniser:
    """Matches utterances against the templates of a set of skills.

    An utterance may join several commands ("go to the kitchen, then tell me your battery"); all of
    its parts must match. A word that no argument knows is corrected when it is nearly one
    ("kichen"), and refused by name otherwise: a robot never guesses where to drive. The templates
    are those of the language's phrasebook and then the skills' own. Words that were learned since
    the last utterance count. `dialogue_skills` come after all the others, and only where every word
    fits. May be used from any thread.
    """

    def __init__(
        self, skills: SkillSet, language: str = ENGLISH, dialogue_skills: SkillSet = NO_SKILLS
    ) -> None:
        codes = dict.fromkeys((language, ENGLISH))
        books = [phrasebook_of(code, skills.values()) for code in codes]
        self._language = language
        self._skills = skills
        self._words = skills.words()
        self._learning = threading.Lock()
        self._readers = [_TemplateReader(skills, book, books[0], dialogue_skills) for book in books]

    def recognise(self, text: str) -> Understood | RefusedCommand | None:
        """Calls, a refusal, or None when this is not a plain command."""
        if len(text) > MAX_CHARACTERS or not is_exact(text, self._language):
            return None
        self._learn()
        plain = digits(" ".join(one_form(text).split()), self._language)
        refused = None
        for reader in self._readers:
            found = reader.read(plain)
            if isinstance(found, Understood):
                return found
            refused = refused or found
        return refused

    def _learn(self) -> None:
        with self._learning:
            words = self._skills.words()
            if words != self._words:
                self._words = words
                for reader in self._readers:
                    reader.learn()


class _TemplateReader:
    """Reads one language, and says in the language of `answers` what it does not know."""

    def __init__(
        self, skills: SkillSet, book: Phrasebook, answers: Phrasebook, dialogue_skills: SkillSet
    ) -> None:
        self._skills = SkillSet([*skills.values(), *dialogue_skills.values()])
        self._book = book
        self._answers = answers
        self._joints = _joints(book.hearing)
        self._reserved = frozenset(map(key, book.hearing.reserved))
        self._strict = compile_templates(self._skills, book, loose=False)
        self._loose = compile_templates(skills, book, loose=True)
        self.learn()

    def learn(self) -> None:
        """Take the words that there are now to choose from; the templates stay as they are."""
        made: dict[int, TextSlotList] = {}  # skills may share their choices
        for name, lists in self._strict.lists.items():
            for argument, one in self._skills[name].choices.items():
                if id(one) not in made:
                    made[id(one)] = word_list(one, self._book)
                lists[argument] = made[id(one)]

    def read(self, text: str) -> Understood | RefusedCommand | None:
        """What `Recogniser.recognise` returns, of a text in digits."""
        plain = digits(text, self._book.code)
        whole = self._one(plain)
        if isinstance(whole, Understood):
            return whole
        parts = [part for part in self._joints.split(plain) if part.strip()]
        if len(parts) > 1:
            found = [self._one(part) for part in parts]
            known = [part for part in found if isinstance(part, Understood)]
            if len(known) == len(parts):
                calls = tuple(call for part in known for call in part.calls)
                return Understood(calls, nearly=any(part.nearly for part in known))
            refusals = [part for part in found if isinstance(part, RefusedCommand)]
            return refusals[0] if refusals and len(known) + len(refusals) == len(parts) else None
        return whole

    def _one(self, part: str) -> Understood | RefusedCommand | None:
        """The call that this sentence is; two bare numbers side by side are read as "x and y"."""
        paired = _PAIR.sub(rf"\1 {self._book.hearing.pair} ", part)
        sentence = written(unpunctuated(separated(paired)), self._book.hearing)
        for call in self._matches(sentence, self._strict):
            return Understood((call,))
        if key(sentence) in self._reserved:
            return None
        for call in self._matches(sentence, self._loose):
            return self._repair(call)
        for call in self._matches(f"{sentence} {_NOTHING}", self._loose):
            if any(value == _NOTHING for value in call.arguments.values()):
                return self._repair(call)
        return None

    def _matches(self, sentence: str, templates: Templates) -> Iterator[Call]:
        plain = folded(sentence)
        fitting = templates.fitting(plain)
        for result in recognize_all(plain, fitting) if fitting.intents else ():
            one = self._skills[result.intent.name]
            arguments = _arguments(one, result, sentence)
            if arguments is None:
                continue
            names = {name: arguments[name].replace("' ", "'") for name in one.new_names}
            if self._are_names(names.values()):
                yield Call(result.intent.name, {**arguments, **names})

    def _are_names(self, given: Collection[str]) -> bool:
        """Whether these may be names: a clause is none, nor is the command that follows."""
        hearing = self._book.hearing
        if not hearing.spaced:
            return not any(word in said for word in hearing.clause_words for said in given)
        return all(hearing.clause_words.isdisjoint(map(key, said.split())) for said in given)

    def _repair(self, call: Call) -> Understood | RefusedCommand | None:
        """Correct near misses among the words of a loose match, or say what is wrong."""
        arguments, nearly = dict(call.arguments), False
        for name, choices in self._skills[call.skill].choices.items():
            said = self._without_articles(str(arguments.get(name, "")))
            if said in ("", _NOTHING) and choices.words:
                return refused(self._answers, "missing_word", name, choices.words)
            if not _may_be_a_name(said, self._book.hearing):
                return None
            if not choices.words:
                return RefusedCommand(
                    self._answers.say("no_words", argument=self._answers.kind(name))
                )
            spoken = {key(one): word for one, word in self._book.heard(choices).items()}
            near = difflib.get_close_matches(key(said), spoken, n=1, cutoff=_NEAR)
            inflected = self._book.fallback is not None
            same = bool(near) and is_same_name(key(said), near[0], inflected=inflected)
            if not near or not (same or self._is_alike(key(said), near[0])):
                return refused(self._answers, "unknown_word", name, choices.words, said)
            nearly |= not same
            arguments[name] = spoken[near[0]]
        return Understood((Call(call.skill, arguments),), nearly)

    def _is_alike(self, said: str, known: str) -> bool:
        """Whether it may be this name misheard, and not another word that holds it."""
        extra = len(said) - len(known)
        longer = known in said and extra > (ENDING if self._book.hearing.spaced else 0)
        return not longer and _alike_word_by_word(said, known)

    def _without_articles(self, said: str) -> str:
        articles = {key(separated(article)) for article in self._book.hearing.articles}
        words = [word for word in said.split() if key(word) not in articles]
        return " ".join(words).replace("' ", "'")


def _alike_word_by_word(said: str, known: str) -> bool:
    """Whether no word is quite another one: shelf B is no shelf A, and "kitchen ft" no kitchen."""
    pairs = list(zip(said.split(), known.split(), strict=False))
    ratios = (difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)
    return len(said.split()) == len(known.split()) and all(one >= _WORD_NEAR for one in ratios)


def refused(
    book: Phrasebook, sentence: str, argument: str, known: Sequence[str], said: str = ""
) -> RefusedCommand:
    """Says that a word is missing or unknown, and some words that are known; all in `detail`."""
    kind = book.kind(argument)
    reason = book.say(sentence, argument=kind, said=said, known=brief(book, known, said))
    return RefusedCommand(reason, whole(book, known))


def _arguments(one: Skill, result: RecognizeResult, sentence: str) -> Mapping[str, Any] | None:
    """The match's slots as arguments, or None where a number was expected and none was said.

    Words that stand for themselves are taken from the sentence with its accents.
    """
    said: dict[str, str] = {}
    for name, entity in result.entities.items():
        said[name] = str(entity.value).strip()
        if is_number_type(one.arguments_model.model_fields[name].annotation):
            if not _NUMBER.fullmatch(said[name]):
                return None
        elif (entity.is_wildcard or name in one.new_names) and entity.text_span:
            said[name] = sentence[slice(*entity.text_span)].strip()
    return one.from_words(said)


def _joints(hearing: Hearing) -> re.Pattern[str]:
    words = "|".join(re.escape(word) for word in hearing.joints) or "(?!)"
    if not hearing.spaced:
        return re.compile(rf"[,;!?\u3001\u3002]*\s*(?:{words})[,\u3001]?\s*|[,;!?\u3001\u3002]\s*")
    return re.compile(
        rf"\s*(?:,|;|\.(?!\d)|(?<!\w)|(?=,))\s*(?:{words})\s+|[;.\u061b\u0964](?!\d)\s+",
        re.IGNORECASE,
    )


def _may_be_a_name(said: str, hearing: Hearing) -> bool:
    """Whether these words may be a name, and not a clause or a number."""
    if any(character.isdigit() for character in said):
        return False
    if not hearing.spaced:
        clause = any(word in said for word in hearing.clause_words)
        return len(said) <= _MAX_UNKNOWN_CHARACTERS and not clause
    words: Sequence[str] = said.split()
    return len(words) <= _MAX_UNKNOWN_WORDS and not hearing.clause_words.intersection(
        map(key, words)
    )
