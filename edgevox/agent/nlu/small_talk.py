"""Small talk, and the short answer to what nothing else answers."""

import re
from collections.abc import Iterator, Sequence

from edgevox.agent.nlu.apart import LIKELY_MORE, OTHER
from edgevox.agent.nlu.decider import PLAINLY_TALK, TALK, Decider
from edgevox.agent.nlu.evidence import QUESTION_MARKS
from edgevox.agent.nlu.questions import asks
from edgevox.agent.nlu.splitting import clauses_of

CHATS, CHATS_APART = 0.5, 0.6
"""Least likelihood of small talk, and of that in one of several clauses."""

CHATS_SURELY = 0.9
"""Likelihood of small talk that outweighs a question to the robot, or that ends other words."""

CHATS_PLAINLY = 0.8
"""The same of small talk that could also be a question about the world in general."""

PLAINLY_OTHER = 0.6
"""Least likelihood of an order that no skill does."""

_STRETCHED = re.compile(r"(\w)\1{2,}")
"""A letter that is typed more often than twice: "hiii"."""


def small_talk_in(text: str, code: str, decider: Decider, least: float = CHATS) -> str:
    """The kind of small talk that a text is: see `say.talk_*` of a language; empty for none.

    `least` is the least likelihood of the whole text. Of several clauses, all of which are talk,
    the likeliest counts, else the last one that plainly is; none if one asks for something else,
    unless the whole text surely is small talk.
    """
    text = _STRETCHED.sub(r"\1", text)
    clauses = clauses_of(text, code)
    kinds = [decider.small_talk(one) for one in clauses]
    kind, likely = decider.small_talk(text)
    parted = len(clauses) > 1 and likely < CHATS_SURELY
    if parted and any(
        less < CHATS and asks(one, code)
        for one, (_, less) in zip(_with_marks(clauses, text), kinds, strict=True)
    ):
        return ""
    if likely >= least:
        return kind
    if least > CHATS:
        return ""
    asked = [decider.asked(one) for one in clauses]
    if {one for one, _ in asked} == {TALK}:
        kind, likely = max(kinds, key=lambda one: one[1])
        return kind if likely >= CHATS_APART else ""
    wants = any(
        one != TALK and sure >= LIKELY_MORE and talk < CHATS
        for (one, sure), (_, talk) in zip(asked, kinds, strict=True)
    )
    plain = (one for one, talk in reversed(kinds) if talk >= CHATS_SURELY)
    return "" if wants else next(plain, "")


def reply_to(text: str, code: str, decider: Decider | None, *, speaks: bool) -> str:
    """The key of the sentence that answers a text which nothing else answers; empty for none.

    It is an order that no skill does, a question, or only a remark. An order that `speaks` of no
    motion is none that a skill does.
    """
    kind, likely = decider.asked(text) if decider else ("", 0.0)
    orders = kind == OTHER and likely >= PLAINLY_OTHER
    if orders and not asks(text.rstrip(QUESTION_MARKS), code):
        return "no_ability"
    if asks(text, code):
        return "not_known"
    if decider is not None and not speaks and decider.is_order(text):
        return "no_ability"
    return "no_answer" if kind == TALK and likely >= PLAINLY_TALK else ""


def _with_marks(clauses: Sequence[str], text: str) -> Iterator[str]:
    """The clauses, each with the mark that ends it in the text."""
    at = 0
    for one in clauses:
        at = text.index(one, at) + len(one)
        yield one + text[at : at + 1].strip()
