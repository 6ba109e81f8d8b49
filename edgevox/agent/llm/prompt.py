"""What a language model is told: its role, its calls, examples, and the chat so far.

`History` keeps the chat within the context window. `PromptPrefill` has the model read the opening
in advance, while the robot already obeys plain commands.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from edgevox.agent.llm.grammar import DO, END, HANDOFF, SAY, is_optional, literal
from edgevox.agent.llm.language_model import ChatMessage, LanguageModel, ModelFailed
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.phrases.tables import SmallTalk
from edgevox.agent.skills import Call, Skill, SkillSet
from edgevox.core.cancel import CancelToken
from edgevox.core.log import get_logger

log = get_logger(__name__)

EXAMPLES_PER_SKILL = 3
MOST_LEARNED = 20
"""Number of learned words that the prompt names; the grammar knows all."""


@dataclass(frozen=True, slots=True)
class Shown:
    """An example: a sentence, and the calls or the words that answer it."""

    sentence: str
    calls: tuple[Call, ...] = ()
    says: str = ""


def system_prompt(
    instructions: str, skills: SkillSet, handoffs: Sequence[str] = (), language: str = ENGLISH
) -> str:
    """The role, the calls there are, and how to answer, in that language."""
    lines = [instructions, ""]
    known = [one for one in skills.values() if one.callable_now]
    if not known and not handoffs:
        lines.append(
            f'Answer with "{SAY}" and one short sentence. Others do what can be done here.'
        )
        return "\n".join([*lines, *_spoken_in(language)])
    lines.append("You can only make these calls:")
    lines += [f"{_signature(one)}: {one.description}" for one in known]
    if handoffs:
        who = " or ".join(literal(name) for name in handoffs)
        lines.append(f"{HANDOFF}(agent={who}): Hand over to a colleague who can do it.")
    lines += [
        "",
        (
            f'Answer a command with "{DO}", the calls, each with a ";" after it, and "{END}". '
            f'Answer everything else with "{SAY}" and one short sentence: greetings, questions '
            "about other things, words without sense, and commands that none of the calls fulfils. "
            "Never do what nobody asked for."
        ),
    ]
    return "\n".join([*lines, *_spoken_in(language)])


def talk_prompt(instructions: str, language: str = ENGLISH) -> str:
    """The role, and how to answer questions about the world in general, in that language."""
    unknown = phrasebook(language).say("not_known")
    rule = f'Answer in one short sentence. If you cannot know it, say "{unknown}"'
    return "\n".join([instructions, "", rule, *_spoken_in(language)])


def everyday(language: str = ENGLISH) -> Sequence[Shown]:
    """Examples of questions that have an answer, and of such that have none."""
    book = phrasebook(language)
    unknown = book.say("not_known")
    return [Shown(one.asked, says=one.answer or unknown) for one in book.everyday]


def _spoken_in(language: str) -> list[str]:
    if language == ENGLISH:
        return []
    name = phrasebook(language).name
    return [f"People speak {name} to you. Every sentence that you say is {name}."]


def examples(
    skills: SkillSet, handoffs: Sequence[str] = (), language: str = ENGLISH
) -> Sequence[Shown]:
    """Examples of every skill, of two calls in one sentence, of small talk and of what is refused.

    They alternate, so that no kind of answer is what the last ones were, and end in words: small
    models repeat what they saw last, and a wrong word costs less than a wrong drive.
    """
    book = phrasebook_of(language, skills.values())
    singles = _singles(skills, book)
    handed = [
        Shown(f"let me talk to the {name}", (Call(HANDOFF, {"agent": name}),)) for name in handoffs
    ]
    calls = _interleave([*singles, *handed], _pairs(singles, len(skills), book.links))
    return _interleave(calls, _interleave(_said(book.declined), _said(book.small_talk)))


def _said(exchanges: Sequence[SmallTalk]) -> list[Shown]:
    return [Shown(one.asked, says=one.answer) for one in exchanges]


def _singles(skills: SkillSet, book: Phrasebook) -> list[Shown]:
    """One example of each skill, then a second one of each, and so on."""
    given = [
        [
            Shown(e.sentence, (Call(name, dict(e.arguments)),))
            for e in book.examples(one)[:EXAMPLES_PER_SKILL]
        ]
        for name, one in skills.items()
    ]
    return [one for each in zip_longest(*given) for one in each if one is not None]


def _pairs(singles: Sequence[Shown], skills: int, links: Sequence[str]) -> list[Shown]:
    """Two sentences in one: of different skills in either order, and of the same one twice."""
    count = len(singles)
    places = ((0, skills - 2), (skills - 2, skills - 1), (skills, 2 * skills), (-1, 1))
    chosen = [(singles[i % count], singles[j % count]) for i, j in places if count > 1]
    return [
        Shown(first.sentence.rstrip(".?! ") + joint + second.sentence, first.calls + second.calls)
        for joint, (first, second) in zip(links, chosen, strict=False)
        if first is not second
    ]


def _interleave(many: Sequence[Shown], few: Sequence[Shown]) -> list[Shown]:
    """Both in their order, evenly mixed, the last of the second at the end."""
    placed = [((index + 0.5) / len(many), one) for index, one in enumerate(many)]
    placed += [((index + 1) / len(few), one) for index, one in enumerate(few)]
    return [one for _, one in sorted(placed, key=lambda pair: pair[0])]


def _signature(one: Skill) -> str:
    """The call as Python would declare it."""
    arguments = ", ".join(
        f"{name}={kind}" + (" or nothing" if is_optional(one, name) else "")
        for name, kind in _kinds(one).items()
    )
    return f"{one.name}({arguments})"


def _kinds(one: Skill) -> Mapping[str, str]:
    """What each argument may be now."""
    known = {
        name: (*choices.fixed, *choices.learned()[-MOST_LEARNED:])
        for name, choices in one.choices.items()
    }
    return {
        name: " or ".join(map(literal, known[name])) if name in known else _kind(kind)
        for name, kind in one.schema.get("properties", {}).items()
    }


def _kind(kind: Mapping[str, Any]) -> str:
    if "enum" in kind:
        return " or ".join(literal(value) for value in kind["enum"])
    if "const" in kind:
        return literal(kind["const"])
    return str(kind.get("type", "value"))


CUT_MARK = " [interrupted]"
"""Ends an answer in the history that the person did not hear to its end."""

_OVERHEAD_TOKENS = 8
"""Number of tokens that a chat template adds to each message, rounded up."""


def size_tokens(count_tokens: Callable[[str], int], messages: Sequence[ChatMessage]) -> int:
    """Number of tokens of these messages in a context window, with those of the chat template."""
    return sum(count_tokens(message.content) + _OVERHEAD_TOKENS for message in messages)


class History:
    """Exchanges, oldest first. The oldest half is forgotten when they outgrow `budget_tokens`.

    Half at once, not one by one: a model keeps what it computed for the part of a chat that did not
    change, and every forgotten exchange changes the chat from its start.
    """

    def __init__(self, count_tokens: Callable[[str], int], budget_tokens: int) -> None:
        self._count = count_tokens
        self._budget = budget_tokens
        self._exchanges: list[tuple[ChatMessage, ChatMessage]] = []
        self._sizes: list[int] = []

    def add(self, said: str, answered: str, *, cut: bool = False) -> None:
        """Remember one exchange."""
        exchange = (
            ChatMessage("user", said),
            ChatMessage("assistant", answered + CUT_MARK if cut else answered),
        )
        self._exchanges.append(exchange)
        self._sizes.append(size_tokens(self._count, exchange))
        while self._exchanges and sum(self._sizes) > self._budget:
            half = (len(self._exchanges) + 1) // 2
            del self._exchanges[:half]
            del self._sizes[:half]

    def clear(self) -> None:
        self._exchanges.clear()
        self._sizes.clear()

    def messages(self) -> Sequence[ChatMessage]:
        return [message for exchange in self._exchanges for message in exchange]


class PromptPrefill:
    """Primes a model on a thread of its own.

    Plain commands never need the model, so they do not wait for this. A sentence for the model that
    comes meanwhile waits for the rest of the priming and is answered sooner because of it. `after`
    blocks until more urgent work is done.
    """

    def __init__(
        self,
        model: LanguageModel,
        messages: Sequence[ChatMessage],
        *,
        after: Callable[[], None] | None = None,
    ) -> None:
        self._model = model
        self._messages = messages
        self._after = after
        self._token = CancelToken()
        self._thread = threading.Thread(target=self._work, name="edgevox-prefill")

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Stop reading and wait for the thread."""
        self._token.cancel("shutting down")
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> None:
        if self._after:
            self._after()
        if self._token.cancelled:
            return
        try:
            self._model.prime(self._messages, self._token)
        except ModelFailed as error:
            log.error("model_not_primed", reason=str(error))  # noqa: TRY400 - its message says it all
