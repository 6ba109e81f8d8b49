"""What a component says of itself, and the registry of those that do."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum


class Level(IntEnum):
    """How well something is, in the words and numbers of `diagnostic_msgs`."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True)
class Component:
    """One component's word: how it is, why in a few words, and what can be read off it."""

    name: str
    level: Level
    message: str
    values: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is not as it should be."""

    level: Level
    text: str


Look = Callable[[], Component]
"""Says how a component is. Quick, and from any thread."""


def component(
    name: str,
    findings: Sequence[Finding] = (),
    *,
    well: str = "works",
    **values: object,
) -> Component:
    """A component with what was found about it, the worst first; `well` if that is nothing.

    Values are shown as text; one that is None is left out, since nobody knows it.
    """
    worst_first = sorted(findings, key=lambda finding: -finding.level)
    level = worst_first[0].level if worst_first else Level.OK
    message = "; ".join(finding.text for finding in worst_first) or well
    return Component(
        name, level, message, {k: _text(v) for k, v in values.items() if v is not None}
    )


class Diagnostics:
    """Components by name, added as parts start and listed in that order."""

    def __init__(self) -> None:
        self._looks: dict[str, Look] = {}

    def add(self, name: str, look: Look) -> None:
        """List this component from now on, in place of one of the same name."""
        self._looks = {**self._looks, name: look}

    def report(self) -> list[Component]:
        """What each says now; one that cannot even be asked is an error, with its reason."""
        return [_ask(name, look) for name, look in self._looks.items()]


def _ask(name: str, look: Look) -> Component:
    try:
        return look()
    except Exception as error:  # noqa: BLE001 - a look that breaks is a finding like any other
        return Component(name, Level.ERROR, f"cannot be looked at: {error!r}")


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.4g}" if isinstance(value, float) else str(value)
