"""The running agent and its interfaces: it is started, served and closed here."""

import time
from collections.abc import Sequence
from contextlib import ExitStack

from edgevox.apps.agent.build import build_parts, start, start_parts
from edgevox.apps.shutdown_signals import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.apps.terminal import run_terminal
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasPicture
from edgevox.robots.flat.viewer import Viewer, has_display

log = get_logger(__name__)


def serve(settings: Settings, body: Body | None, ros_args: Sequence[str]) -> bool:
    """Serve the agent's users, until the program is ended."""
    began_s = time.monotonic()
    with ExitStack() as stack:
        parts = build_parts(stack, settings, body)
        with ShutdownSignals(settings.leave_s, parts.drain) as shutdown:
            start_parts(stack, parts, ros_args)
            if settings.render and has_display() and isinstance(body, HasPicture):
                start(stack, Viewer(body.picture, f"EdgeVox: {body.name}"))
            show(f"{parts.name} is ready. /help shows what can be typed.")
            log.info("ready", agent=parts.name, after_s=round(time.monotonic() - began_s, 1))
            try:
                run_terminal(parts, shutdown)
            finally:
                log.info("shutting_down", agent=parts.name, reason=shutdown.signal or "left")
                parts.drain.stand()  # before anything is closed, since that may hang
    return True
