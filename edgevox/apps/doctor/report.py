"""The doctor's findings for people and for programs."""

import json
from collections.abc import Sequence

from rich.console import Console  # noqa: TID251 - its cells are printable text
from rich.table import Table
from rich.text import Text

from edgevox.apps.doctor.check import CheckAnswer
from edgevox.core.status import Level
from edgevox.core.text import one_line, printable

WIDTH = 110
"""Where there is no terminal, whose own width it would be."""
_SHOWN = {
    Level.OK: ("ok", "green"),
    Level.STALE: ("skipped", "dim"),
    Level.WARN: ("warning", "yellow"),
    Level.ERROR: ("error", "bold red"),
}
"""Each level's word, and its style on a terminal."""


def worst(answers: Sequence[CheckAnswer]) -> Level:
    """The most serious level; what was skipped is fine."""
    levels = {answer.verdict.level for answer in answers} - {Level.STALE}
    return max(levels, default=Level.OK)


def print_table(answers: Sequence[CheckAnswer]) -> None:
    """A row each, and how many of what."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=WIDTH)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for head in ("", "check", "found", "what to do"):
        table.add_column(head, overflow="fold")
    for answer in answers:
        verdict = answer.verdict
        word, style = _SHOWN[verdict.level]
        table.add_row(
            Text(word, style=style),
            one_line(answer.check),
            Text(printable(verdict.found)),
            Text(printable(verdict.advice)),
        )
    console.print(table)
    console.print(_counted(answers))


def as_json(answers: Sequence[CheckAnswer]) -> str:
    """The same as one JSON object."""
    checks = [
        {
            "check": answer.check,
            "grade": _SHOWN[answer.verdict.level][0],
            "found": answer.verdict.found,
            "advice": answer.verdict.advice,
        }
        for answer in answers
    ]
    return json.dumps({"status": _SHOWN[worst(answers)][0], "checks": checks}, indent=2)


def _counted(answers: Sequence[CheckAnswer]) -> str:
    levels = [answer.verdict.level for answer in answers]
    errors, warnings = levels.count(Level.ERROR), levels.count(Level.WARN)
    if not errors and not warnings:
        return "All is well."
    words = [
        f"{count} {word}{'s' * (count > 1)}"
        for count, word in ((errors, "error"), (warnings, "warning"))
        if count
    ]
    return " and ".join(words) + "."
