"""`edgevox`: the voice agent without a robot."""

import argparse
import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.run_program import run_program, secure_ros2, set_up_logs
from edgevox.apps.streams import with_streams
from edgevox.core.settings import Settings, load_settings
from edgevox.robots.plugin import FOR_BODIES
from edgevox.ros2 import split_ros_args

COMMANDS = {
    "completion": "edgevox.apps.completion",
    "interfaces": "edgevox.apps.interfaces",
    "listen": "edgevox.apps.listen",
    "state": "edgevox.apps.state",
    "voiceprint": "edgevox.apps.voiceprint",
    "wyoming": "edgevox.apps.wyoming",
}
"""The first arguments that ask for another command, and its module, imported only then."""
DOCTOR = "doctor"
"""The first argument that asks for the doctor, a program of its own as well."""
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
    if given[:1] == [DOCTOR]:
        from edgevox.apps.doctor.command import main as doctor

        return doctor(given[1:], f"edgevox {DOCTOR}")
    if given and given[0] in COMMANDS:
        return int(import_module(COMMANDS[given[0]]).main(given[1:]))
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
