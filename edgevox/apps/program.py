"""What all programs here have in common: how they serve, how they end, and with which exit code."""

import logging
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack

from edgevox.apps.composition import build_parts, start, start_parts
from edgevox.apps.ending import Ending, Terminated
from edgevox.apps.terminal import run_terminal
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing
from edgevox.robots.capabilities import Body, HasPicture
from edgevox.robots.viewer import Viewer, has_display

OK, FAILED, USAGE_ERROR = 0, 1, 2


def run_program(name: str, prepare: Callable[[], Callable[[], bool]]) -> int:
    """Prepare, then run what came of it; the process's exit code, with the reason on stderr."""

    def fail(error: EdgeVoxError, code: int) -> int:
        print(f"{name}: {error}", file=sys.stderr)
        return code

    try:
        run = prepare()
    except ModelMissing as error:
        return fail(error, FAILED)
    except EdgeVoxError as error:
        return fail(error, USAGE_ERROR)
    try:
        return OK if run() else FAILED
    except InvalidValue as error:
        return fail(error, USAGE_ERROR)
    except EdgeVoxError as error:
        return fail(error, FAILED)
    except (Terminated, KeyboardInterrupt):
        return OK


def serve(settings: Settings, body: Body | None, ros_args: Sequence[str]) -> bool:
    """Be there for whoever talks to it, until somebody leaves."""
    with ExitStack() as stack:
        parts = build_parts(stack, settings, body)
        with Ending() as ending:
            start_parts(stack, parts, ros_args)
            if settings.render and has_display() and isinstance(body, HasPicture):
                start(stack, Viewer(body.picture, f"EdgeVox: {body.name}"))
            print(f"{parts.name} is ready. /help shows what can be typed.", flush=True)
            run_terminal(parts, ending)
    return True


def set_log_level(settings: Settings) -> None:
    """Log to stderr, as much as the settings say."""
    logging.basicConfig(
        level=settings.log_level.upper(), format="%(levelname)s %(name)s: %(message)s"
    )
