"""What the skills of a robot file share: lists of words, and rules for their sentences.

    lists:
      sizes: {values: [small, large], aliases: {big: large}}
    rules:
      please: "[please|could you|I would like]"

A choice takes its words from a list (``list: sizes``); ``<please>`` in a sentence is what the rule
says, as in Home Assistant's sentences. `languages` has the rules of another language.
"""

import re
from collections.abc import Sequence

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile
from edgevox.ros2.robot_file.format import (
    Argument,
    RobotFile,
    Sentences,
    SkillEntry,
    StateEntry,
    WordList,
)

LONGEST_SENTENCE = 10_000
"""In characters, with its rules written out."""
_RULE = re.compile(r"<([^<>]*)>")


def with_shared(robot: RobotFile, file: YamlFile, problems: Problems) -> RobotFile:
    """Return the robot with its lists and rules where its skills name them."""
    shared = _Shared(robot, file, problems)
    shared.check_rules()
    skills = {name: shared.skill(name, one) for name, one in robot.skills.items()}
    states = {name: shared.state(name, one) for name, one in robot.state.items()}
    return robot.model_copy(update={"skills": skills, "state": states})


class _Shared:
    """The lists and rules of a robot file. What is wrong goes to `problems`."""

    def __init__(self, robot: RobotFile, file: YamlFile, problems: Problems) -> None:
        self._robot, self._file, self._problems = robot, file, problems

    def check_rules(self) -> None:
        """Find rules that name themselves, or others that there are not."""
        rules = self._robot.rules
        shared = {ENGLISH: rules, **{c: one.rules for c, one in self._robot.languages.items()}}
        for code, its in shared.items():
            at: Place = () if its is rules else ("languages", code)
            for name in its:
                with self._problems.collect():
                    _Rules(self._robot, self._file, code, (*at, "rules", name)).out(f"<{name}>")

    def skill(self, name: str, entry: SkillEntry) -> SkillEntry:
        """The skill with what it names."""
        at: Place = ("skills", name)
        arguments = dict(entry.arguments)
        for argument, one in entry.arguments.items():
            with self._problems.collect():
                arguments[argument] = self._argument(one, (*at, "arguments", argument))
            self._check_default(arguments[argument], (*at, "arguments", argument))
        languages = {
            code: said.model_copy(update={"sentences": self._sentences(said, code, place)})
            for code, said in entry.languages.items()
            if (place := (*at, "languages", code))
        }
        said = self._sentences(entry, ENGLISH, at)
        changed = {"arguments": arguments, "sentences": said, "languages": languages}
        return entry.model_copy(update=changed)

    def state(self, name: str, entry: StateEntry) -> StateEntry:
        """The state with the rules that its conditions name."""
        when = []
        for index, one in enumerate(entry.when):
            at: Place = ("state", name, "when", index)
            said = self._written(one.sentences, ENGLISH, (*at, "sentences"))
            languages = {
                code: self._written(some, code, (*at, "languages", code))
                for code, some in one.languages.items()
            }
            when.append(one.model_copy(update={"sentences": said, "languages": languages}))
        return entry.model_copy(update={"when": when})

    def _argument(self, one: Argument, at: Place) -> Argument:
        if one.list is None:
            return one
        lists = self._robot.lists
        if one.list not in lists:
            expected = "a list: one of " + (", ".join(lists) or "none")
            raise self._file.wrong((*at, "list"), one.list, expected)
        known = {name: getattr(lists[one.list], name) for name in WordList.model_fields}
        return one.model_copy(update=known)

    def _check_default(self, one: Argument, at: Place) -> None:
        words = one.meanings
        if one.list and words and one.default is not None and one.default not in words:
            expected = "one of " + ", ".join(words)
            wrong = self._file.wrong((*at, "default"), one.default, expected)
            self._problems.found.append(wrong)

    def _sentences(self, said: Sentences, code: str, at: Place) -> list[str]:
        written = self._written(said.sentences, code, (*at, "sentences"))
        return [phrasebook(code).with_any_length(one) for one in written]

    def _written(self, templates: Sequence[str], code: str, at: Place) -> list[str]:
        """These templates with their rules written out."""
        found = list(templates)
        for index, one in enumerate(found):
            with self._problems.collect():
                found[index] = _Rules(self._robot, self._file, code, (*at, index)).out(one)
        return found


class _Rules:
    """The rules of a language, for a template at this place of the file."""

    def __init__(self, robot: RobotFile, file: YamlFile, code: str, at: Place) -> None:
        own = robot.languages.get(code)
        self._rules = {**robot.rules, **(own.rules if own else {})}
        self._code, self._file, self._at = code, file, at

    def out(self, template: str, within: tuple[str, ...] = ()) -> str:
        """The template with these rules written out; what phrasebooks call a rule stays one.

        Raises `InvalidValue`.
        """
        found = _RULE.sub(lambda match: self._rule(match[1], within), template)
        if len(found) > LONGEST_SENTENCE:
            expected = f"at most {LONGEST_SENTENCE} characters with its rules"
            raise self._file.wrong(self._at, template, expected)
        return found

    def _rule(self, name: str, within: tuple[str, ...]) -> str:
        if name in within:
            raise self._file.wrong(self._at, f"<{name}>", "a rule that does not name itself")
        if name in self._rules:
            return f"({self.out(self._rules[name], (*within, name))})"
        if name in phrasebook(self._code).rules:
            return f"<{name}>"
        expected = "a rule: one of " + (", ".join(sorted(self._rules)) or "none")
        raise self._file.wrong(self._at, f"<{name}>", expected)
