"""The language that the agent and its model share: words or calls, never a mixture of both."""

import ast
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from edgevox.agent.llm.grammar import DO, END, HANDOFF, JOINT, SAY, grammar, literal
from edgevox.agent.llm.language_model import ChatMessage
from edgevox.agent.llm.prompt import Shown, everyday, examples, system_prompt, talk_prompt
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.skills import NO_SKILLS, Call, SkillSet
from edgevox.agent.text.spelling import key

_CONTROL = re.compile(r"[\x00-\x1f\x7f]+")


class OutputParser:
    """Reads a model's output as it is generated. Feed all of it, then `finish`."""

    def __init__(self) -> None:
        self._text = ""
        self._said = 0

    def feed(self, piece: str) -> str:
        """The words of this piece that a person may hear; empty for calls."""
        self._text += _CONTROL.sub(" ", piece)
        if not self._text.startswith(SAY):
            return ""
        new = self._text[len(SAY) + self._said :]
        self._said += len(new)
        return new

    def finish(self) -> Sequence[Call]:
        """The calls that were made.

        None at all if their list was cut short: half of it is not what was asked.
        """
        if not self._text.startswith(DO):
            return ()
        try:
            *calls, end = _parts(self._text[len(DO) :])
            return tuple(_call(part) for part in calls) if end.strip() == END else ()
        except (SyntaxError, ValueError):
            return ()


@dataclass(frozen=True)
class Protocol:
    """The common language of one agent and its model.

    `opening` holds the first messages of a chat in which the model may make calls: the
    instructions, the skills and examples. `grammar` is the grammar of its output, which
    `OutputParser` reads; `words_grammar` allows only words and hand-overs. `talk` is the opening
    where it only talks; it shows no calls. All are made for the present `words` of the arguments.
    """

    instructions: str
    skills: SkillSet
    handoffs: tuple[str, ...] = ()
    language: str = "en"
    words: tuple[tuple[tuple[str, str], ...], ...] = field(init=False)
    grammar: str = field(init=False)
    words_grammar: str = field(init=False)
    opening: tuple[ChatMessage, ...] = field(init=False)
    talk: tuple[ChatMessage, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "words", self.skills.words())
        object.__setattr__(self, "grammar", grammar(self.skills, self.handoffs))
        object.__setattr__(self, "words_grammar", grammar(NO_SKILLS, self.handoffs))
        system = system_prompt(self.instructions, self.skills, self.handoffs, self.language)
        shown = examples(self.skills, self.handoffs, self.language)
        object.__setattr__(self, "opening", self._opening(system, shown))
        talk = talk_prompt(self.instructions, self.language)
        object.__setattr__(self, "talk", self._opening(talk, everyday(self.language)))

    def _opening(self, system: str, shown: Sequence[Shown]) -> tuple[ChatMessage, ...]:
        messages = [ChatMessage("system", system)]
        for one in shown:
            answer = self.render_calls(one.calls) if one.calls else self.render(one.says)
            messages += [
                ChatMessage("user", self.prepare(one.sentence)),
                ChatMessage("assistant", answer),
            ]
        return tuple(messages)

    @property
    def acts(self) -> bool:
        """True if the model can make calls or hand over."""
        return bool(self.handoffs) or any(one.callable_now for one in self.skills.values())

    def renewed(self) -> "Protocol":
        """Itself, or another if words were learned or forgotten since it was made."""
        return self if self.words == self.skills.words() else replace(self)

    def without(self, agents: Collection[str]) -> "Protocol":
        """Itself, or another that hands over to none of these."""
        left = tuple(name for name in self.handoffs if name not in agents)
        return self if left == self.handoffs else replace(self, handoffs=left)

    def grammar_of(self, *, ordered: bool) -> str:
        """The grammar of the answer to a sentence that is an order (`ordered`), or to any other."""
        return self.grammar if ordered else self.words_grammar

    def allowed(self, calls: Sequence[Call], text: str, *, ordered: bool) -> Sequence[Call]:
        """The calls that a model may make, without others that the engine's grammar let through.

        Every word that the model fills in must have been said.
        """
        spoken = key(text)
        return [call for call in calls if self._may(call, spoken, ordered=ordered)]

    def _may(self, call: Call, spoken: str, *, ordered: bool) -> bool:
        if call.skill == HANDOFF:
            return call.arguments.get("agent") in self.handoffs
        if not ordered or call.skill not in self.skills:
            return False
        one = self.skills[call.skill]
        return bool(one.free_text) and all(
            key(str(call.arguments.get(name, ""))) in spoken for name in one.free_text
        )

    def parser(self) -> OutputParser:
        """A parser for one answer."""
        return OutputParser()

    def prepare(self, text: str) -> str:
        """An utterance as the model sees it: number words are digits, in metres."""
        return digits(" ".join(text.split()), self.language)

    def render(self, text: str) -> str:
        """An answer in words, as the model would have written it."""
        return SAY + _CONTROL.sub(" ", text)

    def render_calls(self, calls: Sequence[Call]) -> str:
        """Calls, as the model would have written them."""
        written = (f"{call.skill}({_arguments(call.arguments)})" for call in calls)
        return DO + JOINT.join((*written, END))


def _arguments(arguments: Mapping[str, object]) -> str:
    return ", ".join(f"{name}={literal(value)}" for name, value in arguments.items())


def _parts(text: str) -> list[str]:
    """The calls between joints; a joint inside a quoted string is part of the string."""
    outside = re.split(r'("[^"]*")', text)
    marked = [part if index % 2 else part.replace(";", "\n") for index, part in enumerate(outside)]
    return "".join(marked).split("\n")


def _call(text: str) -> Call:
    """Raises `SyntaxError` or `ValueError` for anything but a call with literal arguments."""
    tree = ast.parse(text.strip(), mode="eval").body
    if not isinstance(tree, ast.Call) or not isinstance(tree.func, ast.Name) or tree.args:
        raise ValueError(text)
    arguments = {one.arg: ast.literal_eval(one.value) for one in tree.keywords if one.arg}
    return Call(tree.func.id, arguments)


__all__ = ["HANDOFF", "OutputParser", "Protocol"]
