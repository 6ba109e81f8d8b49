"""Phrasebooks: the sentences that a robot says and understands in one language.

- `suited`, `examples_of`: the templates and examples that fit a skill's arguments.
- `brief`, `whole`, `detail`: long lists; a few words are spoken, all are written.
- `Phrasebook`: all of a language.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from typing import Any

from edgevox.agent.phrases.tables import (
    AnswerWords,
    Everyday,
    Hearing,
    HouseAct,
    Numbers,
    ProgramPhrases,
    Rewriting,
)
from edgevox.agent.skills import Example, Skill, SkillPhrases
from edgevox.agent.skills.skill import MOST_HINTS, OneOf
from edgevox.agent.text.alike import most_alike
from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import (
    Word,
    as_part,
    as_said,
    as_sentence,
    bare,
    fields,
    in_brackets,
    in_english,
    spoken_name,
    word_of,
    worded,
)
from edgevox.core.files.text import one_form
from edgevox.core.files.validation import is_number
from edgevox.core.files.yaml_file import value_key
from edgevox.core.reason import Named, Reason

_RULE = re.compile(r"<(\w+)>")
_PLAIN_WORD = re.compile(r"(?<![\w{<:'\u2019])[^\W\d_]+(?![\w'\u2019])")
"""A word of a template that is no name of a slot or a rule."""
_SLOT = re.compile(r"\{(?:\w+:)?(\w+)\}")


def written_out(template: str, rules: Mapping[str, str]) -> str:
    """A template without the names of rules: each is what it stands for."""
    return _RULE.sub(lambda match: written_out(rules[match[1]], rules), template)


def slots_of(template: str, rules: Mapping[str, str]) -> set[str]:
    """The slots of a template and of the rules that it names."""
    return set(_SLOT.findall(written_out(template, rules)))


def suited(one: Skill, templates: Sequence[str], rules: Mapping[str, str]) -> tuple[str, ...]:
    """The templates that give all arguments that the skill needs, and no other."""
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


MOST_SPOKEN = 4
"""Lists up to this long are spoken whole; of a longer one all but one of so many are named."""


def brief(book: "Phrasebook", names: Sequence[str], said: str = "") -> str:
    """The words as a spoken list; of many, only those nearest to the words `said`."""
    if len(names) <= MOST_SPOKEN:
        return book.listing(names)
    near = _nearest(book, names, said) if said else names[: MOST_SPOKEN - 1]
    first = [str(book.word(name)) for name in near]
    spoken = book.say("separator").join(first)
    return book.say("more", first=spoken, count=len(names) - len(first))


def whole(book: "Phrasebook", names: Sequence[str]) -> str:
    """All of them, as a sentence of its own, if `brief` leaves some out."""
    return book.say("known", known=book.listing(names)) if len(names) > MOST_SPOKEN else ""


def detail(book: "Phrasebook", why: Reason) -> str:
    """The written part of a reason: the whole of its long lists, and names of topics."""
    lists = [value for value in why.values.values() if isinstance(value, tuple)]
    topic = book.say("topic", topic=why.values["topic"]) if "topic" in why.values else ""
    return " ".join(filter(None, (*(whole(book, names) for names in lists), topic)))


def _nearest(book: "Phrasebook", names: Sequence[str], said: str) -> list[str]:
    """The few names that are most like what was said, by whatever they are called."""
    forms: dict[str, str] = {}
    for name in names:
        for one in (name, *book.word(name).heard):
            forms.setdefault(key(one), name)
    size = MOST_SPOKEN - 1
    enough = size * max(1 + len(book.word(name).heard) for name in names)
    near = most_alike(key(said), forms, most=enough)
    return list(dict.fromkeys(forms[one] for one in near))[:size]


_UNITS = (("hours", "hour", 3600), ("minutes", "minute", 60), ("seconds", "second", 1))
_MOST_UNITS = 2
_SECONDS = "_s"
"""The end of the name of a value in seconds: `lasts_s` is told as `{lasts}`, "2 hours"."""
_OTHER = "other"
"""Key for the name of an argument without a name of its own."""
_WORD = "word"
"""Key for the kind of an argument's words, if the argument is unknown."""


@dataclass(frozen=True)
class Phrasebook:
    """The phrases of one language; the skills and the English `fallback` fill its gaps."""

    code: str
    name: str
    sentences: Mapping[str, str]
    hearing: Hearing
    numbers: Numbers
    rules: Mapping[str, str] = field(default_factory=dict)
    words: Mapping[str, Word] = field(default_factory=dict)
    unknown: Word = field(default_factory=lambda: word_of(None))
    own_names: Mapping[str, Word] = field(default_factory=dict)
    skills: Mapping[str, SkillPhrases] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    arguments: Mapping[str, str] = field(default_factory=dict)
    dialogue: Mapping[str, SkillPhrases] = field(default_factory=dict)
    sums: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Wordings of sums, with `{a}` and `{b}`, by kind."""
    everyday: tuple[Everyday, ...] = ()
    """Questions about the world in general, and, with an empty answer, what nobody can know."""
    acts: Mapping[str, HouseAct] = field(default_factory=dict)
    cues: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    answers: AnswerWords = field(default_factory=AnswerWords)
    smoothing: tuple[Rewriting, ...] = ()
    programs: ProgramPhrases = field(default_factory=ProgramPhrases)
    fallback: "Phrasebook | None" = None

    def say(self, name: str, **values: Any) -> str:
        """A sentence of the agent itself. Raises `KeyError` if no language has it."""
        sentence = self.sentences.get(name)
        if sentence is None and self.fallback:
            return self.fallback.say(name, **values)
        return self._smooth(self.sentences[name].format(**values))

    def word(self, name: str) -> Word:
        """A word's forms; those of an unknown one are made of its own name."""
        return self._known(name) or self.unknown.called(name.replace("_", " "))

    def without_article(self, name: str) -> str:
        """A name without the article before it, for a list or a label."""
        for article in self.hearing.articles:
            before = article if article.endswith("'") else f"{article} "
            if name.startswith(before):
                return name.removeprefix(before)
        return name

    def heard(self, choices: OneOf) -> dict[str, str]:
        """Everything that may be said for these words, to the word."""
        own = choices.spoken()
        return {
            said: word
            for word in choices.words
            if key(word) in self.words
            for said in self.words[key(word)].heard
        } | own

    def templates(self, one: Skill) -> tuple[str, ...]:
        """The sentences that call this skill, as hassil reads them; only those that suit it.

        A skill may bring its own in English, beside its function.
        """
        if not self.fallback and one.templates:
            return one.templates
        return suited(one, self._phrases(one).templates, self.rules)

    def asking(self, one: Skill) -> tuple[str, ...]:
        """The sentences that may call this skill, so that the robot asks first."""
        return suited(one, self._phrases(one).asks, self.rules)

    def written_out(self, template: str) -> str:
        """A template without the names of rules."""
        return written_out(template, self.rules)

    def with_any_length(self, template: str) -> str:
        """A template that says metres, by any word for them, for all units of length.

        What is heard in other units has become metres by one certain word.
        """
        lengths = self.numbers.lengths
        if lengths is None or not self.hearing.spaced:
            return template
        metre = next((one for one, length in lengths.units if length == 1.0), None)
        usual = self.rules.get("metres", lengths.base)

        def widened(found: re.Match[str]) -> str:
            said = found[0]
            is_metre = metre is not None and metre.fullmatch(one_form(said))
            return f"({said}|{lengths.base}|{usual})" if is_metre else said

        return _PLAIN_WORD.sub(widened, template)

    def examples(self, one: Skill) -> Sequence[Example]:
        """Sentences that ask for a skill; English ones for words unknown here."""
        if self._is_called_by_its_own(one):
            return one.examples
        own = examples_of(one, self._phrases(one).examples, self.words)
        english = self.fallback.examples(one) if self.fallback else one.examples
        if not own:
            return english
        covered = {value for example in own for value in example.arguments.values()}
        words = {word for choices in one.choices.values() for word in choices.words} - covered
        return own + [e for e in english if words.intersection(e.arguments.values())]

    def acknowledge(self, one: Skill, arguments: Mapping[str, Any]) -> str:
        """The sentence for the beginning of a call; may be empty."""
        said = self._speak(one, one.says, lambda phrases: phrases.says, arguments)
        return said or (self.fallback.acknowledge(one, arguments) if self.fallback else "")

    def report(self, one: Skill, arguments: Mapping[str, Any], result: Mapping[str, Any]) -> str:
        """The sentence for the success of a call; may be empty."""
        values = {**arguments, **result}
        said = self._speak(one, one.done, lambda phrases: phrases.done, values)
        said = f"{said[:1].upper()}{said[1:]}"
        return said or (self.fallback.report(one, arguments, result) if self.fallback else "")

    def tells(self, one: Skill) -> bool:
        """True if the success of a call is reported in words."""
        return bool(one.done or self._phrases(one).done)

    def question(self, calls: Sequence[tuple[Skill, Mapping[str, Any]]]) -> str:
        """Asks whether these calls shall be done: "Shall I go to the kitchen?"."""
        actions = [self.action(one, arguments) for one, arguments in calls]
        if all(actions):
            return self.say("shall_i", actions=self.say("and_then").join(actions))
        told = (self.acknowledge(one, a) or one.description for one, a in calls)
        return self.say("do_this", told=" ".join(told))

    def announcement(self, calls: Sequence[tuple[Skill, Mapping[str, Any]]]) -> str:
        """Says that these calls will be done: "I will go to the kitchen."."""
        actions = [self.action(one, arguments) for one, arguments in calls]
        if all(actions):
            return self.say("announced", actions=self.say("and_then").join(actions))
        return " ".join(
            self.acknowledge(one, a) or as_sentence(one.description) for one, a in calls
        )

    def failure(self, reason: Reason) -> str:
        """The sentence for a call that failed for this reason."""
        return self._because("failed", reason)

    def refusal(self, reason: Reason) -> str:
        """The sentence for a call that was refused for this reason."""
        return self._because("refused", reason)

    def reason(self, why: Reason) -> str:
        """A reason in this language; a sentence without a code stays as it is."""
        sentence = why.sentences.get(self.code) or self.reasons.get(why.code)
        if not sentence:
            return why.text
        said = str(why.values.get("value", ""))
        values = {name: self._about(name, value, said) for name, value in why.values.items()}
        left = [one for name, one in why.values.items() if name not in fields(sentence)]
        return self._smooth(sentence.format(**values)) + in_brackets(left, self.code)

    def can(self, one: Skill) -> str:
        """The ability that this skill gives, as a part of a sentence."""
        return self._phrases(one).can or as_part(one.description)

    def said_for(self, one: Skill) -> Mapping[str, Mapping[str, str]]:
        """Words for values of this skill's arguments and results."""
        return self._phrases(one).words

    def knows(self, one: Skill) -> bool:
        """True if the skill's name is one that robots commonly have."""
        return one.name in self.skills

    def chained(self, sentences: Sequence[str]) -> str:
        """Sentences in sequence: "Going to the kitchen. Then: going to the bedroom."."""
        first, *rest = [sentence for sentence in sentences if sentence] or [self.say("all_right")]
        then = (self.say("then", next=f"{one[0].lower()}{one[1:]}") for one in rest)
        return " ".join([first, *then])

    def duration(self, seconds: float) -> str:
        """A duration in its two largest units: "1 hour and 30 minutes"."""
        left = max(1, round(seconds))
        told: list[str] = []
        for several, one, size in _UNITS:
            number, left = divmod(left, size)
            if number:
                told.append(self.say(one if number == 1 else several, count=number))
        return self.both(told[:_MOST_UNITS])

    def both(self, parts: Sequence[str]) -> str:
        """Some parts as one: "1 hour and 30 minutes"."""
        return self._join(parts)

    def listing(self, names: Sequence[str]) -> str:
        """Some words as one: "the kitchen, the bedroom and the office"."""
        return self._join([str(self.word(name)) for name in names])

    def argument(self, name: str) -> str:
        """The name of an argument: "the distance in metres".

        An axis is called by its letter; an argument without a name in this language is "a value".
        """
        known = self.arguments.get(name) or self.arguments.get(spoken_name(name))
        return known or (name if len(name) == 1 else self.arguments.get(_OTHER, name))

    def kind(self, argument: str) -> str:
        """The kind of an argument's words, such as "room"; "word" for an unknown argument."""
        return argument if argument in self.arguments else self.arguments.get(_WORD, "")

    def _because(self, sentence: str, reason: Reason) -> str:
        said = self.reason(reason)
        return as_sentence(said) if reason.is_sentence else self.say(sentence, reason=bare(said))

    def _about(self, name: str, value: Any, said: str) -> Word | str:
        if name == "argument":
            return self.argument(value)
        return brief(self, value, said) if isinstance(value, tuple) else self._told(value)

    def _told(self, value: str | Reason | Named) -> Word | str:
        """A reason's value for a sentence: another reason, a word with its forms, or a name."""
        if isinstance(value, Reason):
            return bare(self.reason(value))
        if isinstance(value, Named):
            return self.unknown.called(value.names.get(self.code, str(value)))
        return self._known(value) or self.unknown.called(value)

    def _known(self, name: str) -> Word | None:
        """A word by its own name, or by how this language calls it first."""
        return self.words.get(key(name)) or self._first_heard.get(key(name))

    @cached_property
    def _first_heard(self) -> Mapping[str, Word]:
        return {key(one.heard[0]): one for one in self.words.values() if one.heard}

    def slots(self, template: str) -> set[str]:
        """The slots of a template and of the rules that it names."""
        return slots_of(template, self.rules)

    def _phrases(self, one: Skill) -> SkillPhrases:
        ours = (self.skills.get(name) for name in (one.entry, one.name))
        known = next(filter(None, ours), None) or self.dialogue.get(one.name) or SkillPhrases()
        return one.phrases.get(self.code) or known

    def _is_called_by_its_own(self, one: Skill) -> bool:
        """True if a skill brings its own templates or examples in this language."""
        brought = bool(one.templates or one.examples)
        return not self.fallback and brought and self.code not in one.phrases

    def _join(self, parts: Sequence[str]) -> str:
        if len(parts) < 2:
            return "".join(parts)
        first = self.say("separator").join(parts[:-1])
        return self.say("list", first=first, last=parts[-1])

    def _speak(
        self,
        one: Skill,
        english: str,
        part: Callable[[SkillPhrases], Sequence[str]],
        values: Mapping[str, Any],
    ) -> str:
        """A sentence of a skill: the skill's own if that is this language's, else the book's."""
        said = "" if self._speaks(one) else self._first(one, part(self._phrases(one)), values)
        return said or self._formatted(one, english, values)

    def action(self, one: Skill, arguments: Mapping[str, Any]) -> str:
        """What a call does, as the end of a question: "go to the kitchen". May be empty.

        An English one fits no other language's sentence.
        """
        if self._speaks(one):
            return self._formatted(one, one.action, arguments)
        return self._first(one, self._phrases(one).actions, arguments)

    def _speaks(self, one: Skill) -> bool:
        """True if a skill brings its own sentences in this language."""
        return not self.fallback and bool(one.says or one.done or one.action)

    def order(self, one: Skill, arguments: Mapping[str, Any]) -> str:
        """A call as a person orders it. May be empty."""
        said = self._first(one, self._phrases(one).orders, arguments)
        return said or self.action(one, arguments)

    def _first(self, one: Skill, templates: Sequence[str], values: Mapping[str, Any]) -> str:
        """The first of these sentences whose values are all known; empty if there is none."""
        told = {
            name: self._spoken(value) for name, value in worded(values, self.said_for(one)).items()
        }
        told |= {spoken_name(name): value for name, value in told.items()}
        told |= {
            name.removesuffix(_SECONDS): self.duration(value)
            for name, value in values.items()
            if name.endswith(_SECONDS) and is_number(value)
        }
        known = {name for name, value in told.items() if value is not None}
        fit = (template for template in templates if fields(template) <= known)
        template = next(fit, "")
        return self._smooth(template.format(**told))

    def _spoken(self, value: Any) -> Any:
        """A value as sentences use it, or None for one that nothing is known of.

        A flag that is up is there, and says nothing by itself. Words, and things on things, are
        lists.
        """
        if isinstance(value, bool):
            return "" if value else None
        if isinstance(value, str):
            return self.word(value) if value else None
        if isinstance(value, Mapping):
            there = [(name, one["on"]) for name, one in value.items() if "on" in one]
            return self._join([self._thing_at(name, place) for name, place in there]) or None
        if isinstance(value, Sequence):
            return self.listing(list(map(value_key, value))) or None
        return as_said(value)

    def _thing_at(self, name: str, place: str) -> str:
        return self.say("thing_at", thing=self.word(name), place=self.word(place))

    def _formatted(self, one: Skill, english: str, values: Mapping[str, Any]) -> str:
        """A skill's own English sentence, with what its words are called in English."""
        book = self.fallback or self
        told = {
            name: book.english(value) for name, value in worded(values, book.said_for(one)).items()
        }
        return english.format(**told)

    def english(self, value: Any) -> Any:
        """A value as a skill's own English sentences use it."""
        if isinstance(value, str):
            return self.words.get(key(value), in_english(value))
        if isinstance(value, list | tuple):
            return self.listing(list(map(value_key, value)))
        return as_said(value)

    def _smooth(self, text: str) -> str:
        for pattern, replacement in self.smoothing:
            text = pattern.sub(replacement, text)
        return text
