"""The sampling of the robot, as often as pages want it, and never while no page looks."""

import asyncio
from collections.abc import Awaitable, Callable

from edgevox.console.context import ConsoleRobot
from edgevox.console.page_hub import PageHub
from edgevox.core.log import get_logger, worth_a_line

log = get_logger(__name__)

LIVE_S = 1 / 15
"""Seconds between samples: a sample is this old, and some 20 ms more, just before the next one
comes."""
STATUS_S = 1.0
TICK_S = 1.0


async def sample(hub: PageHub) -> None:
    """Tell pages how the robot is, until it is cancelled."""
    loops = [_again(TICK_S, lambda: _tick(hub)), _again(STATUS_S, lambda: _status(hub))]
    if hub.context.robot:
        robot, scene = hub.context.robot, Scene(hub, hub.context.robot)
        loops += [_again(LIVE_S, lambda: _live(hub, robot)), _again(STATUS_S, scene.look)]
    await asyncio.gather(*loops)


class Scene:
    """Tells what does not move once it is another."""

    def __init__(self, hub: PageHub, robot: ConsoleRobot) -> None:
        self._hub = hub
        self._robot = robot
        self._told: object = None

    async def look(self) -> None:
        """Tell it where its version is another."""
        if not self._hub.pages:
            return
        scene = await self._hub.work(self._robot.scene)
        told, self._told = self._told, scene.get("version")
        if self._told != told:
            self._hub.tell({**scene, "type": "scene"}, "scene")


async def _tick(hub: PageHub) -> None:
    hub.tick()


async def _live(hub: PageHub, robot: ConsoleRobot) -> None:
    if any("live" in page.looks for page in hub.pages):
        hub.tell({**await hub.work(robot.live), "type": "live"}, "live", "live")


async def _status(hub: PageHub) -> None:
    if any("status" in page.looks for page in hub.pages):
        hub.tell({**await hub.work(hub.context.status), "type": "status"}, "status", "status")


async def _again(period_s: float, look: Callable[[], Awaitable[None]]) -> None:
    """Look so often; what is late is left out, and what breaks is looked at again."""
    loop, broke = asyncio.get_running_loop(), 0
    due = loop.time()
    while True:
        try:
            await look()
        except Exception as error:
            broke += 1
            if worth_a_line(broke):
                log.exception("console_look_failed", error=repr(error), count=broke)
        due = max(due + period_s, loop.time())
        await asyncio.sleep(due - loop.time())
