"""A page of the console in a browser that was paired, beside what talks to the robot by ROS 2."""

import asyncio
import json
import threading
from typing import Any

import aiohttp
from guards import HUNG_S
from waiting import Heard


class PairedPage:
    """It has the turn. What it sends has left when `send` returns; on a thread of its own it hears.

    It hears all the time, as a browser does: so it answers the robot's pings by itself.
    """

    def __init__(self, pairing: str) -> None:
        self.told = Heard[dict[str, Any]]()
        self._asked = 0
        self._lock = threading.Lock()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="page")
        self._thread.start()
        self._socket = self._there(self._open(*pairing.split("/#pair=")))
        self._hearing = asyncio.run_coroutine_threadsafe(self._hear(), self._loop)
        self.ask(type="lease", action="take")

    def close(self) -> None:
        self._there(self._leave())
        self._hearing.result(HUNG_S)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def send(self, **message: Any) -> int:
        """Say it; the number that the answer names."""
        with self._lock:
            self._asked += 1
            asked = self._asked
        self._there(self._socket.send_str(json.dumps({"id": asked, **message})))
        return asked

    def answer(self, asked: int) -> dict[str, Any]:
        """What was said to this: `ok`, `error` or `pong`."""
        return self.told.wait_for(lambda one: one.get("reply_to") == asked)

    def ask(self, **message: Any) -> dict[str, Any]:
        """Say it, and wait until it is done."""
        told = self.answer(self.send(**message))
        assert told["type"] == "ok", told
        return told

    def has_answered_pings(self) -> None:
        """Wait until it has answered the pings that were sent until now.

        The robot answers behind what it has sent before, and so behind its pings.
        """
        since = len(self.told.messages)
        self._there(self._socket.send_str(json.dumps({"id": 0, "type": "ping", "t": 0.0})))
        self.told.wait_for(lambda one: one["type"] == "pong", since=since)

    def _there(self, work: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(HUNG_S)

    async def _open(self, url: str, code: str) -> aiohttp.ClientWebSocketResponse:
        jar = aiohttp.CookieJar(unsafe=True)
        self._client = aiohttp.ClientSession(cookie_jar=jar, headers={"Origin": url})
        async with self._client.post(f"{url}/api/pair", json={"code": code}) as told:
            assert told.status == 200, await told.text()
        return await self._client.ws_connect(f"{url}/ws", max_msg_size=0)

    async def _hear(self) -> None:
        async for told in self._socket:
            self.told.add(told.json())
        self.told.over()

    async def _leave(self) -> None:
        await self._socket.close()
        await self._client.close()
