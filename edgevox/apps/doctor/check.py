"""A check of the doctor, and its verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

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
