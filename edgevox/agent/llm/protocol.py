"""What the agent and its model say to each other: a model talks, or hands over to another agent.

It makes no calls of skills: what is to be done is read from what people say, by code.
"""

import json
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from edgevox.agent.llm.language_model import ChatMessage
from edgevox.agent.llm.prompt import Shown, everyday, talk_prompt
from edgevox.agent.phrases.load import ENGLISH

SAY, COLLEAGUE = "talk: ", "colleague: "
"""Beginnings of an answer in words, and of the name of the agent that is to answer."""
MAX_SENTENCES = 2
MAX_SENTENCE_CHARACTERS = 160
_CODE = r"(){}\x5b\x5d<>=;_|`\x5e~"
"""Characters of calls and of code, in a character class: no sentence that is spoken has one."""
_WORDS = rf"""
words ::= sentence (" " sentence){{0,{MAX_SENTENCES - 1}}}
sentence ::= [^ .!?{_CODE}\x00-\x1f\x7f] letter{{0,{MAX_SENTENCE_CHARACTERS - 1}}} [.!?]
letter ::= [^.!?{_CODE}\x00-\x1f\x7f] | "." [0-9]
"""
_CONTROL = re.compile(r"[\x00-\x1f\x7f]+")


def grammar(handoffs: Sequence[str] = ()) -> str:
    """A GBNF grammar of a sentence or two, or of a hand-over to one of these agents."""
    names = " | ".join(json.dumps(one, ensure_ascii=False) for one in handoffs)
    other = f' | "{COLLEAGUE}" ({names})' if names else ""
    return f'root ::= "{SAY}" words{other}{_WORDS}'


class OutputParser:
    """Reads a model's output as it is generated. Feed all of it, then `finish`."""

    def __init__(self) -> None:
        self._text = ""
        self._said = 0

    def feed(self, piece: str) -> str:
        """The words of this piece that a person may hear; empty for a hand-over."""
        self._text += _CONTROL.sub(" ", piece)
        if not self._text.startswith(SAY):
            return ""
        new = self._text[len(SAY) + self._said :]
        self._said += len(new)
        return new

    def finish(self) -> str:
        """The name of the agent that it hands over to; empty if it talked."""
        return self._text.removeprefix(COLLEAGUE) if self._text.startswith(COLLEAGUE) else ""


@dataclass(frozen=True)
class Protocol:
    """The common language of one agent and its model.

    `opening` holds the first messages of a chat: the role, and examples. `grammar` is the grammar
    of the model's output, which `OutputParser` reads.
    """

    instructions: str
    handoffs: tuple[str, ...] = ()
    language: str = ENGLISH
    grammar: str = field(init=False)
    opening: tuple[ChatMessage, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "grammar", grammar(self.handoffs))
        object.__setattr__(self, "opening", tuple(self._opening()))

    def _opening(self) -> Sequence[ChatMessage]:
        lines = [talk_prompt(self.instructions, self.language)]
        if self.handoffs:
            names = " or ".join(self.handoffs)
            lines.append(
                f'To hand over to a colleague who can do it, answer "{COLLEAGUE}" and {names}.'
            )
        asked = [Shown(f"let me talk to the {one}", f"{COLLEAGUE}{one}") for one in self.handoffs]
        talked = [Shown(one.asked, self.render(one.says)) for one in everyday(self.language)]
        messages = [ChatMessage("system", "\n".join(lines))]
        for one in (*asked, *talked):
            messages += [
                ChatMessage("user", one.asked),
                ChatMessage("assistant", one.says),
            ]
        return messages

    def without(self, agents: Collection[str]) -> "Protocol":
        """Itself, or another that hands over to none of these."""
        left = tuple(name for name in self.handoffs if name not in agents)
        return self if left == self.handoffs else replace(self, handoffs=left)

    def render(self, text: str) -> str:
        """An answer in words, as the model would have written it."""
        return SAY + _CONTROL.sub(" ", text)
