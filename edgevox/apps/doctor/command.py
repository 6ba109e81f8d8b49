"""`edgevox doctor`, also called `edgevox-doctor`: its findings, for people and for programs."""

import argparse
import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console  # noqa: TID251 - its cells are printable text
from rich.table import Table
from rich.text import Text

from edgevox.apps.doctor.bundle import bundle
from edgevox.apps.doctor.check import Check, CheckAnswer, Situation, ask
from edgevox.apps.doctor.checks import CHECKS
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.robots import ROBOTS
from edgevox.apps.state import write_archive
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.text import one_line, printable
from edgevox.core.settings import ENV_PREFIX, Settings, check_settings, load_settings
from edgevox.core.status import Level

WIDTH = 110
"""The width without a terminal."""
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


WELL, UNWELL = 0, 1
AGENT = "EDGEVOX_AGENT"
PROGRAM = "edgevox-doctor"


@with_streams(PROGRAM, results=True)
def main(argv: Sequence[str] | None = None, program: str = PROGRAM) -> int:
    """Look at the machine; 0 if EdgeVox can run on it, 1 if not, 2 for a wrong command line."""
    arguments = doctor_parser(program).parse_args(argv)
    settings, refused = _settings(given_flags(arguments), arguments.config)
    agent = arguments.robot or os.environ.get(AGENT, "")
    situation = Situation(settings, dict(os.environ), agent, arguments.quick, refused)
    answers = ask(_chosen(arguments.only), situation)
    if arguments.bundle:
        return _write_bundle(program, as_json(answers), situation, arguments)
    if arguments.json:
        show(as_json(answers))
    else:
        print_table(answers)
    limit = Level.WARN if arguments.strict else Level.ERROR
    return UNWELL if worst(answers) >= limit else WELL


def _write_bundle(
    program: str, doctor: str, situation: Situation, arguments: argparse.Namespace
) -> int:
    """Write the archive; what the doctor found wrong is in it, and no failure of this."""
    try:
        if write_archive(bundle(doctor, situation, arguments.logs), arguments.bundle):
            show(f"{arguments.bundle}: read it before you send it; it names machines and rooms")
    except OSError as error:
        show(f"{program}: {error}", error=True)
        return UNWELL
    return WELL


def _settings(flags: Mapping[str, Any], config: Path | None) -> tuple[Settings, str]:
    """The settings; where they are nonsense the defaults, and why."""
    try:
        return load_settings(flags, config), ""
    except InvalidValue as wrong:
        variable = f"{ENV_PREFIX}{wrong.field.upper().removeprefix(ENV_PREFIX)}"
        where = variable if variable in os.environ else f"{wrong.field} in {config}"
        said = f"{where}: {wrong}"
    except EdgeVoxError as wrong:
        said = str(wrong)
    try:
        return check_settings(flags), said
    except InvalidValue as wrong:  # a flag, and perhaps more
        return check_settings({}), str(wrong)


def _chosen(only: Sequence[str] | None) -> list[Check]:
    names = only or [check.name for check in CHECKS]
    return [check for check in CHECKS if check.name in names]


def doctor_parser(program: str) -> argparse.ArgumentParser:
    """The command line of the doctor."""
    parser = argparse.ArgumentParser(
        prog=program,
        description="Check whether this machine can run EdgeVox, and say how to fix problems.",
        epilog="Exit codes: 0 no error, 1 an error (with --strict also a warning), 2"
        " wrong arguments. Checks: "
        + "; ".join(f"{one.name}: {one.about}" for one in CHECKS)
        + ".",
    )
    add_flags(parser, ["plugins", "robot_namespace", "skills"])
    parser.add_argument(
        "--robot", choices=ROBOTS, metavar="ROBOT", help=f"check its models, too [{AGENT}]"
    )
    parser.add_argument(
        "--robot-file",
        type=Path,
        default=argparse.SUPPRESS,
        metavar="FILE",
        help=f"look on the graph for what this robot file names [{ENV_PREFIX}ROBOT_FILE]",
    )
    parser.add_argument(
        "--bundle",
        metavar="FILE",
        help="write one archive for support, without secrets: this report, settings, versions,"
        " health, metrics and ROS 2's graph; - for the output",
    )
    parser.add_argument(
        "--logs",
        default="",
        metavar="FILE",
        help="also put the last lines of this log into the archive; - for the input",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--strict", action="store_true", help="fail on warnings as well")
    parser.add_argument(
        "--quick", action="store_true", help="check only size and stamp of models, not every byte"
    )
    parser.add_argument(
        "--only",
        action="append",
        choices=[check.name for check in CHECKS],
        metavar="CHECK",
        help="run only this check; can be repeated",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
