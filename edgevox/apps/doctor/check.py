"""A check of the doctor, its verdict, and the run of all checks side by side, whatever fails."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from edgevox.core.probe import ProbeFailed, probe_apart
from edgevox.core.settings import Settings
from edgevox.core.status import Level


@dataclass(frozen=True, slots=True)
class CheckVerdict:
    """The result of a check, with advice. A skipped check is stale."""

    level: Level
    found: str
    advice: str = ""


def ok(found: str, advice: str = "") -> CheckVerdict:
    """All is well."""
    return CheckVerdict(Level.OK, found, advice)


def skipped(found: str, advice: str = "") -> CheckVerdict:
    """Make a verdict: there was nothing to check."""
    return CheckVerdict(Level.STALE, found, advice)


def warning(found: str, advice: str = "") -> CheckVerdict:
    """Make a verdict: it works, though not as well as it could."""
    return CheckVerdict(Level.WARN, found, advice)


def error(found: str, advice: str = "") -> CheckVerdict:
    """Make a verdict: it does not work."""
    return CheckVerdict(Level.ERROR, found, advice)


@dataclass(frozen=True, slots=True)
class Situation:
    """The demands on the machine, from the settings and the environment."""

    settings: Settings
    """The defaults, if the settings were refused."""
    environment: Mapping[str, str] = field(default_factory=dict)
    agent: str = ""
    """The robot that is to run; empty for no particular one."""
    quick: bool = False
    """Trust files that are unchanged since they were last read."""
    refused: str = ""
    """The reason why the settings were refused."""


Facts = Mapping[str, Any]
"""The results of a probe, JSON-ready."""
Judge = Callable[[Facts, Situation], CheckVerdict | Sequence[CheckVerdict]]


@dataclass(frozen=True, slots=True)
class Check:
    """A question to the machine."""

    name: str
    about: str
    probe: Callable[[Situation], Facts] | str
    """A function that runs here, or the address (``module:function``) of one that runs in its
    own process."""
    judge: Judge
    needs: tuple[str, ...] = ()
    """Names of other checks: if one of them fails or is skipped, this one is skipped."""
    if_lost: str = ""
    """The advice if the probe's process dies."""


@dataclass(frozen=True, slots=True)
class CheckAnswer:
    """A check with its verdict."""

    check: str
    verdict: CheckVerdict


AT_ONCE = 4


def ask(checks: Sequence[Check], situation: Situation) -> list[CheckAnswer]:
    """The answers of all checks, in their order; a check may give several."""
    with ThreadPoolExecutor(AT_ONCE, thread_name_prefix="doctor") as pool:
        verdicts = list(pool.map(lambda check: _verdicts(check, situation), checks))
    found = {check.name: said for check, said in zip(checks, verdicts, strict=True)}
    return [
        CheckAnswer(check.name, one)
        for check in checks
        for one in _unless_needed_is_missing(check, found[check.name], found)
    ]


def _verdicts(check: Check, situation: Situation) -> Sequence[CheckVerdict]:
    try:
        probe = check.probe
        facts = probe_apart(probe) if isinstance(probe, str) else probe(situation)
        said = check.judge(facts, situation)
    except ProbeFailed as failed:
        return [error(f"could not be checked: {failed}", check.if_lost)]
    except Exception as failed:  # noqa: BLE001 - a check that breaks is a finding like any other
        return [error(f"could not be checked: {failed!r}")]
    return [said] if isinstance(said, CheckVerdict) else said


def _unless_needed_is_missing(
    check: Check, said: Sequence[CheckVerdict], found: dict[str, Sequence[CheckVerdict]]
) -> Iterator[CheckVerdict]:
    missing = (name for name in check.needs if _unusable(found.get(name, ())))
    if name := next(missing, None):
        yield skipped(f"not tried: see {name}")
    else:
        yield from said


def _unusable(said: Iterable[CheckVerdict]) -> bool:
    return any(one.level in (Level.ERROR, Level.STALE) for one in said)
