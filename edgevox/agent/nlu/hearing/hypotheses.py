"""Chooses among several things that may have been said: a plain command, if there is one.

In noise the words that are likeliest are often no order at all, and the order that was given is
among the next ones. Two orders that are nearly as likely are told apart by whoever gave them.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from edgevox.agent.nlu.meaning import ASK_FROM, HEARD_FROM, Meaning
from edgevox.agent.skills import Call
from edgevox.core.commands import Hypothesis

LEAST_SHARE = 0.2
"""What is less likely to have been said is not done in place of words that mean nothing."""
RIVAL = 0.1
"""Another command this many times as likely contests one. Of 400 commands by voices that tune, in
noises of `training/acoustics`, none was done that was not meant; at 0.05 two more are asked about
that were heard rightly."""

_Told = tuple[Hypothesis, Meaning]
Plain = Callable[[str], object]
"""The `Meaning` of words that are a plain command, or something else."""


def likeliest(others: Sequence[Hypothesis], plain: Plain) -> Meaning | None:
    """The one command that is likely enough; asked about if that was hardly heard, or contested."""
    found = _commands(others, plain)
    if not found:
        return None
    shares = [(_share(meaning, found), meaning) for _, meaning in found]
    share, best = max(shares, key=lambda one: one[0])
    if share < LEAST_SHARE:
        return None
    confidence = max(one.confidence for one, meaning in found if _same(meaning, best))
    sure = confidence >= HEARD_FROM and not _has_rival(best, share, found)
    return replace(best, source="reading", confidence=best.confidence if sure else ASK_FROM)


def is_contested(meaning: Meaning, others: Sequence[Hypothesis], plain: Plain) -> bool:
    """Whether another command among the others is nearly as likely as this one.

    The rest of what is likely is that the words were heard as they were understood.
    """
    found = _commands(others, plain)
    heard = 1.0 - sum(one.share for one in others)
    return _has_rival(meaning, heard + _share(meaning, found), found)


def _commands(others: Sequence[Hypothesis], plain: Plain) -> list[_Told]:
    meant = ((one, plain(one.text)) for one in others)
    return [(one, meaning) for one, meaning in meant if isinstance(meaning, Meaning)]


def _has_rival(meaning: Meaning, share: float, found: Sequence[_Told]) -> bool:
    rivals = (other for _, other in found if not _same(other, meaning))
    return any(_share(rival, found) > RIVAL * share for rival in rivals)


def _share(meaning: Meaning, found: Sequence[_Told]) -> float:
    return sum(one.share for one, other in found if _same(other, meaning))


def _same(one: Meaning, other: Meaning) -> bool:
    """Whether the same is done: "walk forward" is to walk as far as "walk forward one metre"."""
    return _done(one) == _done(other)


def _done(meaning: Meaning) -> list[tuple[str, dict[str, Any]]]:
    return [(one.skill, _whole(meaning, one)) for one in meaning.calls]


def _whole(meaning: Meaning, call: Call) -> dict[str, Any]:
    """The arguments, and what those are that need not be given."""
    fields = meaning.agent.every_skill[call.skill].arguments_model.model_fields.items()
    return {name: info.default for name, info in fields} | dict(call.arguments)
