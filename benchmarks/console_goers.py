"""Pages of a console that come, look and go, over and over, until this process is ended.

python benchmarks/console_goers.py ADDRESS CODE; a dot is written for each.
"""

import asyncio
import json
import sys

import aiohttp
from console_viewers import LOOKS

AT_ONCE = 4
HEARD = 5
"""So many messages a page takes before it goes."""


async def come_and_go(url: str, code: str) -> None:
    """Some at once, with the cookie of one code, until this process is ended."""
    headers = {"Origin": url}
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as browser:
        async with browser.post(f"{url}/api/pair", json={"code": code}, headers=headers) as told:
            told.raise_for_status()
        await asyncio.gather(*(_pages(browser, url, headers) for _ in range(AT_ONCE)))


async def _pages(browser: aiohttp.ClientSession, url: str, headers: dict[str, str]) -> None:
    while True:
        async with browser.ws_connect(f"{url}/ws", headers=headers) as page:
            await page.send_str(json.dumps(LOOKS))
            for _ in range(HEARD):
                await page.receive()
        print(".", end="", flush=True)


if __name__ == "__main__":
    asyncio.run(come_and_go(sys.argv[1], sys.argv[2]))
