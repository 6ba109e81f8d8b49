"""The choice among several hypotheses of speech recognition: a plain command, if there is one.

In noise the likeliest words are often no order, and the spoken order is among the next hypotheses.
If two orders are nearly as likely, the robot asks the person.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from edgevox.agent.nlu.meaning import ASK_FROM, HEARD_FROM, Meaning
from edgevox.agent.skills import Call
from edgevox.agent.text.spelling import key
from edgevox.core.commands import Hypothesis

LEAST_SHARE = 0.2
"""Least share of a command that may replace words without a meaning."""
RIVAL = 0.1
"""Another command with more than this part of a command's share contests it. Of 400 commands by the
tuning voices, in noises of `training/acoustics`, no wrong one was done; at 0.05 the robot asks
about two more that were heard correctly."""

_Told = tuple[Hypothesis, Meaning]
Plain = Callable[[str], object]
"""Returns the `Meaning` of a plain command, or another object."""


def likeliest(others: Sequence[Hypothesis], plain: Plain) -> Meaning | None:
    """The likeliest command, if likely enough; unsure if it was hardly heard or is contested."""
    found = _commands(others, plain)
    if not found:
        return None
    shares = [(_share(meaning, found), meaning) for _, meaning in found]
    share, best = max(shares, key=lambda one: one[0])
    if share < LEAST_SHARE:
        return None
    confidence = max(one.confidence for one, meaning in found if is_same(meaning, best))
    sure = confidence >= HEARD_FROM and not _has_rival(best, share, found)
    return replace(best, source="reading", confidence=best.confidence if sure else ASK_FROM)


def is_contested(meaning: Meaning, others: Sequence[Hypothesis], plain: Plain) -> bool:
    """True if another command among the hypotheses is nearly as likely as this meaning.

    The share that the hypotheses leave belongs to the words as they were understood.
    """
    found = _commands(others, plain)
    heard = 1.0 - sum(one.share for one in others)
    return _has_rival(meaning, heard + _share(meaning, found), found)


def breaks_off(meaning: Meaning, text: str, others: Sequence[Hypothesis], plain: Plain) -> bool:
    """True if other hypotheses that are likely begin with these words and go on to say more.

    "Get me a cappuccino," may be all that could be told of "Get me a cappuccino with sugar". What
    means the same is no more.
    """
    words, share = key(text).split(), 0.0
    for one in others:
        more = key(one.text).split()
        if len(more) > len(words) > 0 and more[: len(words)] == words:
            told = plain(one.text)
            share += 0.0 if isinstance(told, Meaning) and is_same(told, meaning) else one.share
    return share > RIVAL * (1.0 - sum(one.share for one in others))


def _commands(others: Sequence[Hypothesis], plain: Plain) -> list[_Told]:
    meant = ((one, plain(one.text)) for one in others)
    return [(one, meaning) for one, meaning in meant if isinstance(meaning, Meaning)]


def _has_rival(meaning: Meaning, share: float, found: Sequence[_Told]) -> bool:
    rivals = (other for _, other in found if not is_same(other, meaning))
    return any(_share(rival, found) > RIVAL * share for rival in rivals)


def _share(meaning: Meaning, found: Sequence[_Told]) -> float:
    return sum(one.share for one, other in found if is_same(other, meaning))


def is_same(one: Meaning, other: Meaning) -> bool:
    """True if both do the same: "walk forward" goes as far as "walk forward one metre"."""
    return _done(one) == _done(other)


def _done(meaning: Meaning) -> list[tuple[str, dict[str, Any]]]:
    return [(one.skill, _whole(meaning, one)) for one in meaning.calls]


def _whole(meaning: Meaning, call: Call) -> dict[str, Any]:
    """The arguments with the defaults of those that were not given."""
    fields = meaning.agent.every_skill[call.skill].arguments_model.model_fields.items()
    return {name: info.default for name, info in fields} | dict(call.arguments)
