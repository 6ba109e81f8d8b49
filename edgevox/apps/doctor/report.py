"""The doctor's findings for people and for programs."""

import json
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edgevox.apps.doctor.verdict import Answer, Grade

WIDTH = 110
"""Where there is no terminal, whose own width it would be."""
_STYLES = {
    Grade.OK: "green",
    Grade.SKIPPED: "dim",
    Grade.WARNING: "yellow",
    Grade.ERROR: "bold red",
}


def worst(answers: Sequence[Answer]) -> Grade:
    """The most serious grade; what was skipped is fine."""
    grades = {answer.verdict.grade for answer in answers} - {Grade.SKIPPED}
    return max(grades, key=lambda grade: grade.weight, default=Grade.OK)


def print_table(answers: Sequence[Answer]) -> None:
    """A row each, and how many of what."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=WIDTH)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for head in ("", "check", "found", "what to do"):
        table.add_column(head, overflow="fold")
    for answer in answers:
        verdict = answer.verdict
        mark = Text(verdict.grade.value, style=_STYLES[verdict.grade])
        table.add_row(mark, answer.check, Text(verdict.found), Text(verdict.advice))
    console.print(table)
    console.print(_counted(answers))


def as_json(answers: Sequence[Answer]) -> str:
    """The same as one JSON object."""
    checks = [
        {
            "check": answer.check,
            "grade": answer.verdict.grade.value,
            "found": answer.verdict.found,
            "advice": answer.verdict.advice,
        }
        for answer in answers
    ]
    return json.dumps({"status": worst(answers).value, "checks": checks}, indent=2)


def _counted(answers: Sequence[Answer]) -> str:
    grades = [answer.verdict.grade for answer in answers]
    errors, warnings = grades.count(Grade.ERROR), grades.count(Grade.WARNING)
    if not errors and not warnings:
        return "All is well."
    words = [
        f"{count} {word}{'s' * (count > 1)}"
        for count, word in ((errors, "error"), (warnings, "warning"))
        if count
    ]
    return " and ".join(words) + "."
