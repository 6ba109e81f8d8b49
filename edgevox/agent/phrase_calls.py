"""What people say to call a skill, of what a phrasebook has for skills of its name."""

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest

from edgevox.agent.choices import MOST_HINTS, OneOf
from edgevox.agent.phrase_forms import fields, in_english, spoken_name
from edgevox.agent.phrase_words import Word
from edgevox.agent.skills import Example, Skill
from edgevox.agent.spelling import key

_RULE = re.compile(r"<(\w+)>")
_SLOT = re.compile(r"\{(?:\w+:)?(\w+)\}")


def written_out(template: str, rules: Mapping[str, str]) -> str:
    """A template without the names of rules: each is what it stands for."""
    return _RULE.sub(lambda match: written_out(rules[match[1]], rules), template)


def slots_of(template: str, rules: Mapping[str, str]) -> set[str]:
    """The slots of a template and of the rules that it names."""
    return set(_SLOT.findall(written_out(template, rules)))


def suited(one: Skill, templates: Sequence[str], rules: Mapping[str, str]) -> tuple[str, ...]:
    """Those that give all arguments that the skill needs, and no other."""
    infos = one.arguments_model.model_fields
    required = {spoken_name(name) for name, info in infos.items() if info.is_required()}
    names = _names(one)
    return tuple(
        _renamed(template, names)
        for template in templates
        if required <= slots_of(template, rules) <= names.keys()
    )


def examples_of(
    one: Skill, examples: Sequence[Example], words: Mapping[str, Word]
) -> list[Example]:
    """A phrasebook's examples of a skill, and hints of the words that it takes."""
    names = _names(one)
    own = [
        each
        for example in examples
        for each in _of_each_word(_renamed_example(example, names), one.choices)
    ]
    hints = [
        Example(hint, {name: word})
        for name, choices in one.choices.items()
        for word, hint in (_hints(choices, words) if one.moves else ())
    ]
    return own + hints


def _names(one: Skill) -> dict[str, str]:
    """The skill's arguments, by what phrasebooks call them."""
    return {spoken_name(name): name for name in one.arguments_model.model_fields}


def _renamed(template: str, arguments: Mapping[str, str]) -> str:
    """A template with its slots called as these arguments are."""
    return re.sub(r"\{(\w+)\}", lambda match: f"{{{arguments[match[1]]}}}", template)


def _renamed_example(example: Example, arguments: Mapping[str, str]) -> Example:
    values = {arguments[name]: value for name, value in example.arguments.items()}
    return Example(_renamed(example.sentence, arguments), values)


def _of_each_word(example: Example, choices: Mapping[str, OneOf]) -> Iterator[Example]:
    """An example with a slot is one of each word that may stand there, a few at most."""
    slot = next(iter(fields(example.sentence)), "")
    if slot not in choices:
        yield example
        return
    for word in choices[slot].fixed[:MOST_HINTS]:
        sentence = example.sentence.format(**{slot: in_english(word)})
        yield Example(sentence, {**example.arguments, slot: word})


def _hints(choices: OneOf, words: Mapping[str, Word]) -> list[tuple[str, str]]:
    """Words with a hint of each in turn, a few of them."""
    known = [(word, words[key(word)]) for word in choices.words if key(word) in words]
    rounds = zip_longest(*([(word, hint) for hint in one.hints] for word, one in known))
    return [pair for each in rounds for pair in each if pair][:MOST_HINTS]
