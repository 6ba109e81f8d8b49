"""Forms of words and sentences that phrasebooks need, whatever the language."""

import re
from collections.abc import Iterator, Mapping
from string import Formatter
from typing import Any

from edgevox.agent.choices import MOST_HINTS, OneOf
from edgevox.agent.skills import Example

_RULE = re.compile(r"<(\w+)>")
_ONE_NAME = {"location": "room"}
"""What phrasebooks call by another name: all places are spoken of as rooms."""


def renamed(template: str, arguments: Mapping[str, str]) -> str:
    """A template with its slots called as these arguments are."""
    return re.sub(r"\{(\w+)\}", lambda match: f"{{{arguments[match[1]]}}}", template)


def renamed_example(example: Example, arguments: Mapping[str, str]) -> Example:
    """An example with its slots and arguments called as these are."""
    values = {arguments[name]: value for name, value in example.arguments.items()}
    return Example(renamed(example.sentence, arguments), values)


def of_each_word(example: Example, choices: Mapping[str, OneOf]) -> Iterator[Example]:
    """An example with a slot is one of each word that may stand there, a few at most."""
    slot = next(iter(fields(example.sentence)), "")
    if slot not in choices:
        yield example
        return
    for word in choices[slot].fixed[:MOST_HINTS]:
        sentence = example.sentence.format(**{slot: in_english(word)})
        yield Example(sentence, {**example.arguments, slot: word})


def written_out(template: str, rules: Mapping[str, str]) -> str:
    """A template without the names of rules: each is what it stands for."""
    return _RULE.sub(lambda match: written_out(rules[match[1]], rules), template)


def bare(sentence: str) -> str:
    """Without the full stop: it becomes part of another sentence."""
    return sentence.rstrip(". \u3002\u0964")


def as_part(sentence: str) -> str:
    """A sentence as a part of another."""
    return continued(sentence).rstrip(".")


def continued(sentence: str) -> str:
    """A sentence as the end of another."""
    return f"{sentence[:1].lower()}{sentence[1:]}"


def in_english(value: Any) -> Any:
    """A value as English sentences use it."""
    return value.replace("_", " ") if isinstance(value, str) else value


def fields(template: str) -> set[str]:
    """The values that a sentence needs, without their forms: "{room.to}" needs "room"."""
    names = (name for _, name, _, _ in Formatter().parse(template) if name)
    return {re.split(r"[.\[]", name)[0] for name in names}


def spoken_name(argument: str) -> str:
    """How phrasebooks call an argument or a result of this name."""
    return _ONE_NAME.get(argument, argument)
