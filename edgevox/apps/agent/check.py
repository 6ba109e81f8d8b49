"""`--check`: what a robot can do, as the given files and settings make it, and what cannot work.

`conflicts` says some sentences of each template to the recogniser of all skills. A sentence with a
stop word, one that another skill gets, and one that nothing understands can never work.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import Any

from hassil.expression import Alternative, Expression, Group, ListReference, TextChunk
from hassil.parse_expression import parse_sentence

from edgevox.agent.known import VALUE, StateCondition
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.name_rules import check_skills
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import STOP, Skill, SkillSet
from edgevox.agent.stop.words import find_stop_word
from edgevox.agent.text.spelling import key
from edgevox.apps.agent.policy import build_guard, strange_names
from edgevox.apps.robots import about, gather_skills
from edgevox.apps.streams import show
from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.files.text import one_line
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, FromFile, TellsConditions

SHORT = 60
"""Instead of a longer template, one of its sentences is shown."""


def check_robot(body: Body, settings: Settings) -> bool:
    """Print the skills of a body that is not started, each with what it can be told.

    Also what its policy names and it has not, the skills of its file that are off, and sentences
    that can never work. True if there are none of these two. Raises `InvalidValue` for a name that
    people need for something else, and for a policy that cannot be used.
    """
    guard = build_guard(settings, Bus(), body)
    check_skills(body.skills)
    skills = gather_skills(body, settings).skills
    if itself := about(body):
        show(one_line(itself))
    english = phrasebook(ENGLISH)
    show(f"{body.name} has {len(skills)} skills:")
    for one in skills:
        templates = [english.written_out(template) for template in english.templates(one)]
        said = [sentence for sentence in templates if len(sentence) <= SHORT]
        said += [_plainest(template, one, english) for template in templates[:1]]
        show(one_line(f"  {one.name}: {one.description} {said[0] if said else ''}".rstrip()))
    if waits := _conditions(body):
        show("orders can wait until:")
    for condition in waits.values():
        expression = parse_sentence(condition.sentences[ENGLISH][0]).expression
        plain = _sentences(expression, {VALUE: [f"{{{VALUE}}}"]})[0]
        show(one_line(f"  {' '.join(plain.split())}"))
    for text in strange_names(guard, skills):
        show(one_line(f"the policy names what the robot has not: {text}"))
    return _tell_file(body, skills) if isinstance(body, FromFile) else True


def _tell_file(body: FromFile, skills: Sequence[Skill]) -> bool:
    """Print what of the body's file cannot work; False if there is such a thing."""
    works = not body.skills_off
    for name, why in body.skills_off.items():
        show(one_line(f"{name} is off: {why}"), error=True)
    notes = [f"note: {one}" for one in body.file_notes]
    for one in (*conflicts(body, skills), *_stops(body), *notes):
        show(one_line(str(one)), error=True)
        works &= isinstance(one, str)
    return works


MOST_SAMPLES = 200
"""Sentences of a template that are tried."""
UNDERSTOOD = (
    "a sentence that is understood: a length is heard in metres, whatever is said"
    ' ("{height} metres" hears "10 centimetres" as 0.1)'
)


def conflicts(body: FromFile, skills: Sequence[Skill]) -> Iterator[InvalidValue | str]:
    """The sentences of the body's file that can never work, at most one of each template.

    A text is only a note: of a sentence that takes one from the robot's own skills.
    """
    own = body.file_sentences
    named = {one.name: one for one in skills}
    for code in dict.fromkeys(code for _, code, _ in own):
        others = [one for one in skills if one.name not in {name for name, _, _ in own}]
        heard = Recogniser(SkillSet(skills), code), Recogniser(SkillSet(others), code)
        book = phrasebook_of(code, skills)
        for (name, language, template), where in own.items():
            if language != code or name not in named:
                continue
            found = (
                conflict
                for sentence in _samples(template, named[name], book)
                if (conflict := _conflict(sentence, named[name], book, heard, where))
            )
            if first := next(found, None):
                yield first


def _conditions(body: object) -> Mapping[str, StateCondition]:
    return body.conditions if isinstance(body, TellsConditions) else {}


def _stops(body: FromFile) -> Iterator[InvalidValue]:
    """The conditions of the body that would stop it, at most one sentence of each."""
    for name, one in _conditions(body).items():
        for code, templates in one.sentences.items():
            said = (s for t in templates for s in _sentences(parse_sentence(t).expression, {}))
            found = ((s, word) for s in said if (word := find_stop_word(code, s)))
            if stopping := next(found, None):
                expected = f"a sentence without {stopping[1]!r}, which stops the robot"
                yield InvalidValue(f"state.{name.split()[0]}.when", stopping[0], expected)


def _conflict(
    sentence: str,
    one: Skill,
    book: Phrasebook,
    heard: tuple[Recogniser, Recogniser],
    where: str,
) -> InvalidValue | str | None:
    """What is in the way of this sentence of a skill; None if it works."""
    if word := find_stop_word(book.code, sentence):
        return InvalidValue(where, sentence, f"a sentence without {word!r}, which stops the robot")
    if key(sentence) in map(key, (*book.hearing.reserved, *book.answers.yes, *book.answers.no)):
        return InvalidValue(where, sentence, "another sentence: it answers the robot")
    every, others = heard
    found = every.recognise(sentence)
    if not isinstance(found, Understood) or found.unsure:
        return InvalidValue(where, sentence, UNDERSTOOD)
    if [call.skill for call in found.calls] != [one.name]:
        taken = " and ".join(call.skill for call in found.calls)
        return InvalidValue(where, sentence, f"another sentence: it asks for {taken}")
    if left := sorted(_required(one) - found.calls[0].arguments.keys()):
        expected = f"a sentence with {{{left[0]}}}, or a default for this argument"
        return InvalidValue(where, sentence, expected)
    also = others.recognise(sentence)
    if isinstance(also, Understood) and not also.unsure and also.calls[0].skill != STOP:
        return f"note: {where}: {sentence!r} no longer asks for {also.calls[0].skill}"
    return None


def _required(one: Skill) -> set[str]:
    fields = one.arguments_model.model_fields.items()
    return {name for name, field in fields if field.is_required()}


def _samples(template: str, one: Skill, book: Phrasebook) -> Iterator[str]:
    """Some sentences of a template: each of its alternatives is in one of them."""
    values = {name: _values(name, one, book) for name in one.arguments_model.model_fields}
    expression = parse_sentence(book.written_out(template)).expression
    for sentence in _sentences(expression, values)[:MOST_SAMPLES]:
        yield " ".join(sentence.split())


def _plainest(template: str, one: Skill, book: Phrasebook) -> str:
    """A sentence of a template without what may be left out."""
    values = {name: _values(name, one, book) for name in one.arguments_model.model_fields}

    def said(part: Expression) -> str:
        match part:
            case Alternative():
                return "" if part.is_optional else said(part.items[0])
            case Group():
                return "".join(map(said, part.items))
        return _sentences(part, values)[0]

    return " ".join(said(parse_sentence(template).expression).split())


def _values(name: str, one: Skill, book: Phrasebook) -> list[str]:
    """What people may say for an argument: a few words, or a number within its bounds."""
    if name in one.choices:
        words = one.choices[name].words
        return [str(book.word(word).heard[0]) for word in words] or [""]
    schema: Mapping[str, Any] = one.schema["properties"][name]
    if schema.get("type") not in ("number", "integer"):
        return ["true" if schema.get("type") == "boolean" else "something"]
    low = schema.get("minimum", schema.get("exclusiveMinimum", 1))
    high = schema.get("maximum", schema.get("exclusiveMaximum", max(low, 5)))
    middle = (low + high) / 2
    number = min(high, max(low, round(middle)))
    return [f"{number:g}"]


def _sentences(part: Expression, values: Mapping[str, list[str]]) -> list[str]:
    """So many sentences of a part that each of its alternatives is in one."""
    match part:
        case TextChunk():
            return [part.original_text]
        case ListReference():
            return values.get(part.slot_name, ["something"])
        case Alternative():
            return [one for item in part.items for one in _sentences(item, values)]
        case Group():
            several = [_sentences(item, values) for item in part.items]
            rows = [list(row) for row in zip_longest(*several)]
            firsts = [found[0] if found else "" for found in several]
            filled = [
                [first if said is None else said for said, first in zip(row, firsts, strict=True)]
                for row in rows
            ]
            return ["".join(row) for row in filled] or [""]
    return [""]
