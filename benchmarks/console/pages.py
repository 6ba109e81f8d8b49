"""Pages of a console, in a process of their own, until it is ended.

    python benchmarks/console/pages.py ADDRESS CODE HOW_MANY

They look, and say so once. Without a number they come, look and go; a dot is written for each.
"""

import asyncio
import json
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import aiohttp

LOOKS = {"type": "look", "id": 1, "what": ["live", "status"]}
AT_ONCE = 4
HEARD = 5
"""So many messages a page takes before it goes."""


async def look(url: str, code: str, many: int) -> None:
    """So many that stay."""
    async with _paired(url, code) as browser:
        sockets = [await browser.ws_connect(f"{url}/ws", headers=_from(url)) for _ in range(many)]
        for one in sockets:
            await one.send_str(json.dumps(LOOKS))
        print("look", flush=True)
        await asyncio.gather(*(_hear(one) for one in sockets))


async def come_and_go(url: str, code: str) -> None:
    """Some at once, over and over."""
    async with _paired(url, code) as browser:
        await asyncio.gather(*(_one_after_the_other(browser, url) for _ in range(AT_ONCE)))


@asynccontextmanager
async def _paired(url: str, code: str) -> AsyncIterator[aiohttp.ClientSession]:
    """A browser with the cookie of this code."""
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as browser:
        given = {"code": code}
        async with browser.post(f"{url}/api/pair", json=given, headers=_from(url)) as told:
            told.raise_for_status()
        yield browser


def _from(url: str) -> dict[str, str]:
    return {"Origin": url}


async def _one_after_the_other(browser: aiohttp.ClientSession, url: str) -> None:
    while True:
        async with browser.ws_connect(f"{url}/ws", headers=_from(url)) as page:
            await page.send_str(json.dumps(LOOKS))
            for _ in range(HEARD):
                await page.receive()
        print(".", end="", flush=True)


async def _hear(one: aiohttp.ClientWebSocketResponse) -> None:
    async for _ in one:
        pass


if __name__ == "__main__":
    match sys.argv[1:]:
        case [url, code, many]:
            asyncio.run(look(url, code, int(many)))
        case [url, code]:
            asyncio.run(come_and_go(url, code))
