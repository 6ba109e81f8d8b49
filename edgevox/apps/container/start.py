"""The last step of the entrypoint: check the environment, then become the program."""

import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress

from edgevox.apps.container.environment import NO_ROBOT, prepared
from edgevox.apps.container.peers import with_addresses, with_server_addresses
from edgevox.apps.health import FROZEN_NOTE
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import InvalidValue
from edgevox.core.process import usable_cpus
from edgevox.security.startup import secured

USAGE = 64
"""EX_USAGE of sysexits.h: nothing was started."""
NOT_EXECUTABLE, NOT_FOUND = 126, 127
"""The exit codes of shells."""
DOCTOR = ("edgevox", "doctor")


@with_streams("edgevox")
def main(arguments: Sequence[str] | None = None) -> int:
    """Never returns where all is well; else the exit code, its reason on stderr."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with suppress(OSError):
            FROZEN_NOTE.unlink()  # of the agent before this one
        environment = _environment(given)
        command = command_of(given, environment)
        environment = secured(environment, command[0], _say)
    except InvalidValue as error:
        _say(str(error))
        return USAGE
    # NumPy's library would else start a thread for each core of the machine, allowed or not.
    environment.setdefault("OMP_NUM_THREADS", str(usable_cpus()))
    try:
        os.execvpe(command[0], command, environment)  # noqa: S606 - a list, not a shell's line
    except FileNotFoundError:
        _say(f"{command[0]}: no such command")
        return NOT_FOUND
    except OSError as error:
        _say(f"{command[0]}: {error.strerror}")
        return NOT_EXECUTABLE


def _environment(command: Sequence[str]) -> dict[str, str]:
    """What to start the command in. The doctor starts in a wrong one too: it is there to help."""
    try:
        environment = with_addresses(prepared(os.environ, _say), _say)
        return with_server_addresses(environment, _say)
    except InvalidValue as error:
        if tuple(command[:2]) != DOCTOR:
            raise
        _say(str(error))
        return dict(os.environ)


def command_of(arguments: Sequence[str], environment: Mapping[str, str]) -> list[str]:
    """Return the command: the arguments; if there are none, or only flags, the agent with them."""
    if arguments and not arguments[0].startswith("-"):
        return list(arguments)
    agent = environment["EDGEVOX_AGENT"]
    program = ["edgevox"] if agent == NO_ROBOT else ["edgevox-agent", agent]
    return [*program, "--ros2", *arguments]


def _say(text: str) -> None:
    show(f"edgevox: {text}", error=True)


if __name__ == "__main__":
    sys.exit(main())
