"""`edgevox completion SHELL`: prints what makes a shell complete EdgeVox's commands.

The script holds all words, so that no key press starts Python. zsh reads that of bash.
"""

import argparse
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from edgevox.apps.agent.main import agent_parser
from edgevox.apps.doctor.command import doctor_parser
from edgevox.apps.streams import show, with_streams
from edgevox.core.languages import LANGUAGES

PROGRAMS: Mapping[str, Callable[[], argparse.ArgumentParser]] = {
    "edgevox-agent": agent_parser,
    "edgevox-doctor": partial(doctor_parser, "edgevox-doctor"),
}
FILES = ("FILE", "FOLDER")
"""What a flag's value is called if it is a path."""


@with_streams("edgevox", results=True)
def main(argv: Sequence[str] | None = None) -> int:
    """Print the script; the process's exit code."""
    parser = argparse.ArgumentParser(
        prog="edgevox completion",
        description="Print the completion of edgevox-agent and edgevox-doctor for a shell.",
    )
    parser.add_argument("shell", choices=("bash", "zsh", "fish"))
    shell = parser.parse_args(argv).shell
    if shell == "zsh":
        show("autoload -Uz bashcompinit && bashcompinit")
    write = _fish if shell == "fish" else _bash
    for program, build in PROGRAMS.items():
        for line in write(program, build()):
            show(line)
    return 0


def _bash(program: str, parser: argparse.ArgumentParser) -> Iterator[str]:
    function = "_" + program.replace("-", "_")
    flags = [flag for one in _flags(parser) for flag in one.option_strings]
    yield f"{function}() {{"
    yield "  local now=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}"
    yield "  [[ $now == = ]] && now="
    yield "  [[ $before == = ]] && before=${COMP_WORDS[COMP_CWORD-2]}"
    yield "  COMPREPLY=()"
    yield "  case $before in"
    for one in _flags(parser):
        if one.nargs != 0:
            yield f"    {'|'.join(one.option_strings)}) {_bash_value(one)}return ;;"
    yield "  esac"
    yield f"  local words={shlex.quote(' '.join(_choices(parser)))}"
    yield f"  [[ $now == -* ]] && words={shlex.quote(' '.join(flags))}"
    yield '  COMPREPLY=($(compgen -W "$words" -- "$now"))'
    yield "}"
    yield f"complete -F {function} {program}"


def _bash_value(action: argparse.Action) -> str:
    if choices := _values(action):
        words = shlex.quote(" ".join(choices))
        return f'COMPREPLY=($(compgen -W {words} -- "$now")); '
    return 'COMPREPLY=($(compgen -f -- "$now")); ' if action.metavar in FILES else ""


def _fish(program: str, parser: argparse.ArgumentParser) -> Iterator[str]:
    for word in _choices(parser):
        yield f"complete -c {program} -f -a {word}"
    for one in _flags(parser):
        names = " ".join(
            f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}"
            for flag in one.option_strings
        )
        value = "" if one.nargs == 0 else " -r -F" if one.metavar in FILES else " -x"
        words = " ".join(_values(one))
        listed = f" -a {shlex.quote(words)}" if words else ""
        about = shlex.quote((one.help or "").replace("%%", "%"))
        yield f"complete -c {program} {names}{value}{listed} -d {about}"


def _flags(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    return [one for one in _actions(parser) if one.option_strings]


def _choices(parser: argparse.ArgumentParser) -> list[str]:
    """The words that stand without a flag, such as the names of robots."""
    return [word for one in _actions(parser) if not one.option_strings for word in _values(one)]


def _actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    return parser._actions  # noqa: SLF001 - argparse lists them nowhere else


def _values(action: argparse.Action) -> list[str]:
    """The values that a flag takes: its choices, or those that its name in the help lists."""
    if action.dest == "language":
        return list(LANGUAGES)
    if action.choices:
        return [str(one) for one in action.choices if " " not in str(one)]
    listed = action.metavar if isinstance(action.metavar, str) else ""
    return [one for one in listed.split("|") if one != "''"] if "|" in listed else []
