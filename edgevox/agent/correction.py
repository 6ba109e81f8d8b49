"""Corrects a call: "no, to the office" is the same call with another value of one argument."""

from collections.abc import Mapping
from typing import Any

from edgevox.agent.answers import Answers
from edgevox.agent.numbers import digits, is_exact
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill
from edgevox.core.json_reader import is_number
from edgevox.core.text import one_form

_IT = "it"
"""Stands for what was spoken of last, so it corrects nothing."""


def correct(call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook) -> Call | None:
    """The call that is meant instead; None unless the words say so and leave no doubt.

    Words are those that the skill's templates know for the argument in this language; numbers
    replace all of the call's, so there must be as many.
    """
    if not answers.may_correct(text) or not is_exact(text, book.code):
        return None
    found = [*_words(call, one, text, answers, book)]
    if len(found) == 1:
        return Call(call.skill, {**call.arguments, **found[0]})
    if found:
        return None
    names = [name for name, value in call.arguments.items() if is_number(value)]
    said = answers.numbers(digits(" ".join(one_form(text).split()), book.code))
    if not names or len(names) != len(said):
        return None
    changed = one.from_words(dict(zip(names, said, strict=True)))
    return Call(call.skill, {**call.arguments, **changed})


def _words(
    call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook
) -> list[Mapping[str, Any]]:
    """Each argument that could be meant, with its value."""
    found: list[Mapping[str, Any]] = []
    for name, choices in one.choices.items():
        spoken = {said: word for said, word in book.heard(choices).items() if word != _IT}
        value = answers.value(text, spoken, str(call.arguments.get(name)))
        found += [{name: value}] if value else []
    return found
