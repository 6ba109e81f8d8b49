"""What all programs here have in common: how they end, and with which exit code."""

import logging
import sys
from collections.abc import Callable

from edgevox.apps.ending import Terminated
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing

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


def set_log_level(settings: Settings) -> None:
    """Log to stderr, as much as the settings say."""
    logging.basicConfig(
        level=settings.log_level.upper(), format="%(levelname)s %(name)s: %(message)s"
    )
