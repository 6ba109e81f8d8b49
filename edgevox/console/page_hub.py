"""The pages' common state: the pages, the lease, the driver, and messages for all.

It belongs to the loop's thread, except for `tell_soon` and the handlers of the bus.

`Driving` is driving by a stick: it goes on only while a page repeats its command.
"""

import asyncio
import json
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from typing import Any, Protocol

from edgevox.console.context import ConsoleContext, ConsoleRobot
from edgevox.console.lease import Lease, LeaseState
from edgevox.console.outbox import Outbox
from edgevox.console.sessions import Session, Sessions
from edgevox.console.sockets.messages import LastTurns, Shown, messages_of
from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import ControlChanged, Event
from edgevox.core.log import get_logger
from edgevox.core.motion.software_stop import StopState
from edgevox.core.reason import Reason

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


GONE = 4401
"""Close code: this session is no longer let in."""
SLOW = 4408
"""Close code: the page is too slow for messages that it must not miss."""
FLOOD = 4429
"""Close code: this page says far too much."""


class OpenPage(Protocol):
    """A page as the hub sees it."""

    session: Session
    outbox: Outbox
    looks: frozenset[str]
    language: str

    def hang_up(self, code: int) -> None:
        """Close its socket."""

    def stopped(self, mark: int) -> None:
        """React to a stop, or its release: the interlock is at `mark`."""


class PageHub:
    """Made and used on the loop's thread, from `open` to `close`."""

    def __init__(
        self,
        context: ConsoleContext,
        sessions: Sessions,
        clock: Clock,
        workers: ThreadPoolExecutor,
    ) -> None:
        self.context = context
        self.sessions = sessions
        self.lease = Lease(clock)
        self.pages: list[OpenPage] = []
        self.last_turns = LastTurns()
        self.workers = workers
        self.driving: Driving | None = None
        self._thread = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._forget: list[Callable[[], object]] = []
        self._told_lease = LeaseState()

    def open(self, loop: asyncio.AbstractEventLoop) -> None:
        """Hear the bus and the stop from now on."""
        self._loop = loop
        self._thread = threading.get_ident()
        self.context.interlock.on_stop(self._stopped)
        if self.context.robot:
            self.driving = Driving(self.context.robot, loop.call_later)
        self._forget = [
            self.context.bus.subscribe(Shown, self._heard),
            self.context.bus.subscribe(ControlChanged, self._changed),
            self.context.safety.listen(lambda _: self._soon(self._tell_stop)),
        ]
        if self.context.follow_log:
            self._forget.append(self.context.follow_log(self._logged))
        if self.context.recorder:
            self._forget.append(self.context.recorder.listen(self._records))

    def close(self) -> None:
        """Stop listening to the bus; halt the driven robot."""
        for forget in self._forget:
            forget()
        if self.driving:
            self.driving.halt()

    async def work(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call what may take long, on a thread of its own."""
        return await asyncio.get_running_loop().run_in_executor(self.workers, function, *arguments)

    # Who is there

    def enter(self, page: OpenPage) -> None:
        """A page is there."""
        self.pages.append(page)
        self.lease.came(page.session.id)

    def leave(self, page: OpenPage) -> None:
        """Forget a page; halt the robot if the page drove."""
        if self.driving:
            self.driving.release(page)
        self.pages.remove(page)
        if all(one.session.id != page.session.id for one in self.pages):
            self.lease.gone(page.session.id)
        self.tell_lease()

    def tick(self) -> None:
        """Once a second.

        Disconnect revoked sessions, and take the lease back from absent holders.
        """
        for page in list(self.pages):
            if not self.sessions.is_there(page.session):
                self.dismiss(page)
        self.lease.tick()
        self.tell_lease()

    def dismiss(self, page: OpenPage) -> None:
        """A page's session is over."""
        self.lease.revoke(page.session.id)
        self.tell_lease()
        page.hang_up(GONE)

    # What everybody is told

    def stop(self, who: str) -> None:
        """The software stop: done before this returns. Raises what cannot be done."""
        try:
            self.context.safety.stop(who)
        except Exception:
            if self.context.robot:
                self.context.robot.halt()
            raise
        finally:
            if self.driving:
                self.driving.forget()

    def tell(self, message: Mapping[str, Any], newest: str = "", looks: str = "") -> None:
        """Send this to all, or to those who look; with `newest`, in place of the last of it."""
        pages = [page for page in self.pages if not looks or looks in page.looks]
        text = encode(message) if pages else None
        if text is None:
            return
        for page in pages:
            if newest:
                page.outbox.put_newest(newest, text)
            else:
                page.outbox.put(text)

    def tell_soon(self, message: Mapping[str, Any], newest: str = "") -> None:
        """The same, from any thread."""
        self._soon(lambda: self.tell(message, newest))

    def tell_lease(self) -> None:
        """Tell a change of the lease; halt the robot if its former holder drove."""
        state = self.lease.state
        if state == self._told_lease:
            return
        if state.holder != self._told_lease.holder and self.driving:
            self.driving.halt()
        self._told_lease = state
        for page in self.pages:
            text = encode({"type": "lease", **self.lease_of(page.session)})
            if text:
                page.outbox.put_newest("lease", text)

    def lease_of(self, session: Session) -> dict[str, Any]:
        """The lease as a page of this session is told it."""
        state = self.lease.state
        return {
            "holder": state.holder,
            "name": self._name(state.holder),
            "mine": state.holder == session.id,
            "waiting": [{"client": one, "name": self._name(one)} for one in state.waiting],
        }

    @property
    def commander(self) -> str:
        """The name of the lease's holder; empty without one."""
        return self._name(self.lease.state.holder)

    def stop_of(self) -> dict[str, Any]:
        """The stop as pages are told it."""
        return stop_json(self.context.safety.state)

    def controls_of(self) -> dict[str, Any]:
        """The settings that can change."""
        controls = self.context.controls
        return {
            "language": controls.language,
            "voice": controls.voice,
            "muted": controls.muted,
            "confirm": controls.confirm,
            "voices": list(controls.voices),
        }

    def _name(self, client: str | None) -> str:
        names = {page.session.id: page.session.name for page in self.pages}
        return names.get(client or "", "")

    # What other threads say

    def _heard(self, event: Event) -> None:
        reason = getattr(event, "reason", None)
        for message in messages_of(event):
            if isinstance(reason, Reason):
                self._soon(partial(self._tell_why, message, reason))
            else:
                self._soon(partial(self._tell_talk, message))

    def _tell_talk(self, message: Mapping[str, Any]) -> None:
        self.last_turns.add(message)
        self.tell(message)

    def _tell_why(self, message: Mapping[str, Any], reason: Reason) -> None:
        """Tell each page in its own language why."""
        for page in self.pages:
            why = self.context.explain(reason, page.language)
            if text := encode({**message, "why": why}):
                page.outbox.put(text)

    def _logged(self, line: Mapping[str, Any]) -> None:
        if any("log" in page.looks for page in self.pages):
            self._soon(lambda: self._tell_line(line))

    def _tell_line(self, line: Mapping[str, Any]) -> None:
        """Send a line to the pages that show the log.

        A slow page misses it, and stays connected.
        """
        if text := encode({"type": "log", **line}):
            for page in self.pages:
                if "log" in page.looks:
                    page.outbox.put_if_room(text)

    def _changed(self, _event: ControlChanged) -> None:
        self._soon(lambda: self.tell({"type": "controls", **self.controls_of()}, "controls"))

    def _records(self, running: bool) -> None:
        """Tell all pages, whatever they show: their words are recorded."""
        self.tell_soon({"type": "recording", "running": running}, "recording")

    def _stopped(self, mark: int) -> None:
        """React to a stop on any thread; a page that has just asked for it is told at once."""
        if threading.get_ident() == self._thread:
            self._mark_pages(mark)
        else:
            self._soon(partial(self._mark_pages, mark))

    def _mark_pages(self, mark: int) -> None:
        for page in self.pages:
            page.stopped(mark)

    def _tell_stop(self) -> None:
        if self.driving and self.context.safety.state.engaged:
            self.driving.halt()
        self.tell({"type": "stop", **self.stop_of()}, "stop")

    def _soon(self, act: Callable[[], None]) -> None:
        if self._loop:
            with suppress(RuntimeError):  # it was closed just now
                self._loop.call_soon_threadsafe(act)


def stop_json(state: StopState) -> dict[str, Any]:
    """The stop, as pages are told it."""
    return {"engaged": state.engaged, "by": state.by, "since": state.since}


def encode(message: Mapping[str, Any]) -> str | None:
    """Write JSON that a browser can read; None, with a line in the log, if that is impossible."""
    try:
        return json.dumps(message, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError) as error:
        log.warning("console_not_json", kind=message.get("type"), error=repr(error))
        return None
