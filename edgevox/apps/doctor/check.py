"""What a check is, and what it finds."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from edgevox.core.settings import Settings
from edgevox.core.status import Level


@dataclass(frozen=True, slots=True)
class CheckVerdict:
    """What was found, and what to do about it. What was not looked at is stale: skipped."""

    level: Level
    found: str
    advice: str = ""


def ok(found: str, advice: str = "") -> CheckVerdict:
    """All is well."""
    return CheckVerdict(Level.OK, found, advice)


def skipped(found: str, advice: str = "") -> CheckVerdict:
    """There was nothing to check."""
    return CheckVerdict(Level.STALE, found, advice)


def warning(found: str, advice: str = "") -> CheckVerdict:
    """It works, though not as well as it could."""
    return CheckVerdict(Level.WARN, found, advice)


def error(found: str, advice: str = "") -> CheckVerdict:
    """It does not work."""
    return CheckVerdict(Level.ERROR, found, advice)


@dataclass(frozen=True, slots=True)
class Situation:
    """What is asked of the machine: by the settings, and by the environment.

    `agent` is the robot that shall run, empty for none in particular. `quick` is whether to believe
    that files are what they were when they were last read. `refused` is what the settings were
    refused for; `settings` are the defaults then.
    """

    settings: Settings
    environment: Mapping[str, str] = field(default_factory=dict)
    agent: str = ""
    quick: bool = False
    refused: str = ""


Facts = Mapping[str, Any]
"""What a probe saw, JSON-ready."""
Judge = Callable[[Facts, Situation], CheckVerdict | Sequence[CheckVerdict]]


@dataclass(frozen=True, slots=True)
class Check:
    """One question to the machine.

    `probe` is a function that runs here, or the address (``module:function``) of one that runs in a
    process of its own, and `if_lost` what to do if that dies. Without what it `needs` it does not
    count.
    """

    name: str
    about: str
    probe: Callable[[Situation], Facts] | str
    judge: Judge
    needs: tuple[str, ...] = ()
    if_lost: str = ""


@dataclass(frozen=True, slots=True)
class CheckAnswer:
    """A check with its verdict."""

    check: str
    verdict: CheckVerdict
