"""`edgevox`: the voice agent without a robot."""

import argparse
import sys
from collections.abc import Callable, Sequence

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.run_program import run_program, secure_ros2, set_up_logs
from edgevox.apps.streams import with_streams
from edgevox.core.settings import Settings, load_settings
from edgevox.robots.plugin import FOR_BODIES
from edgevox.ros2 import split_ros_args

DOCTOR = "doctor"
"""The first argument that asks for the doctor instead."""
LISTEN = "listen"
"""The first argument that shows what is heard instead."""
COMPLETION = "completion"
"""The first argument that prints the completion for a shell instead."""
INTERFACES = "interfaces"
"""The first argument that builds a robot's interfaces instead."""
STATE = "state"
"""The first argument that exports or imports what a robot keeps instead."""
WYOMING = "wyoming"
"""The first argument that offers hearing and voices to others instead."""
VOICEPRINT = "voiceprint"
"""The first argument that enrols and forgets people's voices instead."""
OF_ROBOTS = FOR_BODIES | {
    "frame_prefix",
    "odom_frame",
    "plugins",
    "publish_clock",
    "render",
    "ros2_state_hz",
    "skills",
}
"""Settings that are about a body."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run it; the process's exit code."""
    given = list(sys.argv[1:] if argv is None else argv)
    if given[:1] == [LISTEN]:
        from edgevox.apps.listen import main as listen

        return listen(given[1:])
    if given[:1] == [DOCTOR]:
        from edgevox.apps.doctor.command import main as doctor

        return doctor(given[1:], f"edgevox {DOCTOR}")
    if given[:1] == [WYOMING]:
        from edgevox.apps.wyoming import main as wyoming

        return wyoming(given[1:])
    if given[:1] == [VOICEPRINT]:
        from edgevox.apps.voiceprint import main as voiceprint

        return voiceprint(given[1:])
    if given[:1] == [INTERFACES]:
        from edgevox.apps.interfaces import main as interfaces

        return interfaces(given[1:])
    if given[:1] == [STATE]:
        from edgevox.apps.state import main as state

        return state(given[1:])
    if given[:1] == [COMPLETION]:
        from edgevox.apps.completion import main as completion

        return completion(given[1:])
    return _run(given)


@with_streams("edgevox")
def _run(given: Sequence[str]) -> int:
    own, ros = split_ros_args(given)
    arguments = _parser().parse_args(own)

    def prepare() -> Callable[[], bool]:
        from edgevox.apps.agent.build import serve

        settings = load_settings(given_flags(arguments), arguments.config)
        set_up_logs("edgevox", settings)
        secure_ros2("edgevox", settings)
        return lambda: serve(settings, None, ros)

    return run_program("edgevox", prepare)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox",
        usage="%(prog)s [FLAG ...] [--ros-args ...]",
        description="A voice agent to talk to. edgevox-agent is one with a robot's body;"
        " edgevox listen shows what a microphone hears; edgevox doctor checks this machine;"
        " edgevox interfaces builds a robot's ROS 2 interfaces;"
        " edgevox voiceprint enrols people by their voice;"
        " edgevox state moves what a robot keeps to another computer; edgevox wyoming offers"
        " hearing and voices to Home Assistant; edgevox completion prints the completion for a"
        " shell.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    add_flags(parser, [name for name in Settings.model_fields if name not in OF_ROBOTS])
    return parser


if __name__ == "__main__":
    sys.exit(main())
