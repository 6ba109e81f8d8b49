"""`edgevox`: the voice agent without a robot."""

import argparse
import sys
from collections.abc import Callable, Sequence

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.program import run_program, set_log_level
from edgevox.apps.serving import serve
from edgevox.core.settings import Settings, load_settings
from edgevox.ros2 import split_ros_args

OF_ROBOTS = frozenset(
    {
        "external_namespace",
        "frame_prefix",
        "locations",
        "max_angular",
        "max_linear",
        "mjcf",
        "model_source",
        "odom_frame",
        "publish_clock",
        "render",
        "ros2_state_hz",
        "seed",
        "world",
    }
)
"""Settings that are about a body."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run it; the process's exit code."""
    own, ros = split_ros_args(sys.argv[1:] if argv is None else argv)
    arguments = _parser().parse_args(own)

    def prepare() -> Callable[[], bool]:
        settings = load_settings(given_flags(arguments), arguments.config)
        set_log_level(settings)
        return lambda: serve(settings, None, ros)

    return run_program("edgevox", prepare)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox",
        description="A voice agent to talk to. edgevox-agent is one with a robot's body.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    add_flags(parser, [name for name in Settings.model_fields if name not in OF_ROBOTS])
    return parser
