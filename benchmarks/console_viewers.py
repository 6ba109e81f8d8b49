"""Viewers of a console, in a process of their own: they look at the robot and say so once.

python benchmarks/console_viewers.py ADDRESS CODE HOW_MANY
"""

import asyncio
import json
import sys

import aiohttp

LOOKS = {"type": "look", "id": 1, "what": ["live", "status"]}


async def look(url: str, code: str, many: int) -> None:
    """All of them, with the cookie of one code, until this process is ended."""
    headers = {"Origin": url}
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as browser:
        async with browser.post(f"{url}/api/pair", json={"code": code}, headers=headers) as told:
            told.raise_for_status()
        sockets = [await browser.ws_connect(f"{url}/ws", headers=headers) for _ in range(many)]
        for one in sockets:
            await one.send_str(json.dumps(LOOKS))
        print("look", flush=True)
        await asyncio.gather(*(_hear(one) for one in sockets))


async def _hear(one: aiohttp.ClientWebSocketResponse) -> None:
    async for _ in one:
        pass


if __name__ == "__main__":
    asyncio.run(look(sys.argv[1], sys.argv[2], int(sys.argv[3])))
