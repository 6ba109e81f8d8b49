"""Driving by a stick: it goes on only while a page repeats its command."""

import asyncio
from collections.abc import Callable

from edgevox.console.context import ConsoleRobot
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger

log = get_logger(__name__)

HEARTBEAT_S = 0.3
"""The robot is halted after this many seconds without a command."""


class Driving:
    """The page that drives; the robot halts when the page lets go, falls silent, or is gone."""

    def __init__(
        self, robot: ConsoleRobot, later: Callable[[float, Callable[[], None]], asyncio.TimerHandle]
    ) -> None:
        self._robot = robot
        self._later = later
        self._page: object | None = None
        self._holding: object | None = None
        self._timer: asyncio.TimerHandle | None = None

    @property
    def is_on(self) -> bool:
        """Whether a page drives."""
        return self._page is not None

    def is_free_for(self, page: object) -> bool:
        """Return whether no other page drives now."""
        return self._page in (None, page)

    def steer(self, page: object, linear_m_s: float, angular_rad_s: float, mark: int) -> None:
        """Go on, or begin. Raises `EdgeVoxError`, and then it is halted if it drove."""
        self._holding = page
        try:
            self._robot.drive(linear_m_s, angular_rad_s, mark)
        except EdgeVoxError:
            self.halt()
            raise
        except Exception:
            self._page = page  # it may have begun
            self.halt()
            raise
        self._page = page
        self._cancel()
        self._timer = self._later(HEARTBEAT_S, self._silent)

    def release(self, page: object) -> None:
        """A page lets go, or is gone; nothing where it does not drive."""
        if self._page is page:
            self.halt()
        if self._holding is page:
            self._holding = None
            self._robot.let_go()

    def halt(self) -> None:
        """End it, with one zero; nothing where nothing drives."""
        if self._page is None:
            return
        self.forget()
        try:
            self._robot.halt()
        except Exception:
            log.exception("console_halt_failed")

    def forget(self) -> None:
        """Forget the driver: another part has halted the robot."""
        self._page = None
        self._cancel()

    def _silent(self) -> None:
        log.info("console_drive_silent")
        self.halt()

    def _cancel(self) -> None:
        if self._timer:
            self._timer.cancel()
            self._timer = None
