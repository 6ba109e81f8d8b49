"""Whoever means ill, or is merely slow, delays nobody, and last of all a stop."""

import asyncio
import json
import socket
from collections.abc import Iterator
from contextlib import AsyncExitStack
from pathlib import Path

import aiohttp
import pytest
from support.clock import HeldClock

from edgevox.console.door import MOST, MOST_UNKNOWN
from edgevox.console.outbox import MOST_WAITING, Outbox
from edgevox.console.sessions import Role
from edgevox.console.sockets.control import BURST
from edgevox.core.events import TokenGenerated
from tests.console_rig import WAIT_S, Rig, console

CONNECTIONS = 6
"""So many a browser opens to one host at once."""


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with console(tmp_path) as made:
        yield made


async def _stops(rig: Rig) -> None:
    async with rig.page(Role.VIEWER) as page:
        assert (await page.ask(type="stop"))["type"] == "ok"


def test_a_message_of_ten_megabytes_ends_its_page_only(rig: Rig) -> None:
    async def send() -> int | None:
        async with rig.page() as page:
            try:
                await page.socket.send_str(json.dumps({"type": "text", "text": "x" * 10_000_000}))
                return await page.closed()
            except (aiohttp.ClientError, ConnectionError):
                return None
            finally:
                await _stops(rig)

    assert asyncio.run(send()) in (1009, None)
    assert rig.submitted == []


@pytest.mark.parametrize(
    "text",
    [
        "", "null", "[]", "{", '{"id":1}', '{"id":1,"type":"nothing"}', "[" * 60_000,
        '{"id":1,"type":"drive","linear":NaN,"angular":0}',
        '{"id":1,"type":"drive","linear":1e999,"angular":0}',
        '{"id":-1,"type":"ping","t":1}', '{"id":true,"type":"resume"}',
        '{"id":1,"type":"resume","more":1}',
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_and_does_nothing(rig: Rig, text: str) -> None:
    async def send() -> dict[str, object]:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            await page.socket.send_str(text)
            told = await page.until("error")
            await _stops(rig)
            return told

    assert asyncio.run(send())["reason"] == "invalid"
    assert rig.submitted == []
    assert rig.robot.steered == []


def test_binary_ends_its_page(rig: Rig) -> None:
    async def send() -> None:
        async with rig.page() as page:
            await page.socket.send_bytes(b"\0" * 100)
            await page.closed()

    asyncio.run(send())


def test_pings_and_looks_of_many_tabs_are_no_commands(tmp_path: Path) -> None:
    async def send(rig: Rig) -> str:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            for _ in range(2 * BURST):
                await page.send(type="ping", t=1.0)
                await page.send(type="look", what=[])
            return (await page.ask(type="resume"))["type"]

    with console(tmp_path, clock=HeldClock(1000.0)) as rig:
        assert asyncio.run(send(rig)) == "ok"


def test_a_flood_is_refused_then_hung_up_on_and_a_stop_in_it_is_done(tmp_path: Path) -> None:
    async def send(rig: Rig) -> int | None:
        async with rig.page() as page:
            for _ in range(60):
                await page.send(type="resume")
            refused = await page.until("error")
            while refused["reason"] != "rate":
                refused = await page.until("error")
            assert (await page.ask(type="stop"))["type"] == "ok"
            try:
                for _ in range(2000):
                    await page.send(type="look", what=[])
            except (aiohttp.ClientError, ConnectionError):
                return 4429
            return await page.closed()

    with console(tmp_path, clock=HeldClock(1000.0)) as rig:
        assert asyncio.run(send(rig)) in (4408, 4429, None)
        assert rig.stop.state.engaged


def test_a_thousand_connections_leave_those_who_are_in_and_let_others_in(rig: Rig) -> None:
    async def crowd() -> int:
        address = ("127.0.0.1", rig.server.port)
        async with rig.page() as page:
            held = []
            for _ in range(1000):
                one = socket.create_connection(address, timeout=WAIT_S)
                one.setblocking(False)
                held.append(one)
                if len(held) > 200:
                    held.pop(0).close()
            assert (await page.ask(type="stop"))["type"] == "ok"
            there = int(rig.server.status().values["connections"])
            for one in held:
                one.close()
        await _stops(rig)
        return there

    assert asyncio.run(crowd()) <= MOST
    assert MOST_UNKNOWN < MOST


def test_browsers_behind_one_address_do_not_shut_each_other_out(rig: Rig) -> None:
    async def load(browsers: int) -> set[int]:
        async with AsyncExitStack() as stack:
            answers = []
            for number in range(browsers):
                cookie = rig.cookie(Role.VIEWER) if number % 2 else {}
                client = await stack.enter_async_context(aiohttp.ClientSession(cookies=cookie))
                parts = [client.get(rig.server.url + "/") for _ in range(CONNECTIONS)]
                answers += await asyncio.gather(*parts)  # each keeps its connection
            return {answer.status for answer in answers}

    assert asyncio.run(load(2 * (MOST_UNKNOWN // CONNECTIONS))) == {200}


def test_a_slow_reader_is_hung_up_on_and_delays_nobody(rig: Rig) -> None:
    async def crowd() -> str:
        async with rig.page(Role.VIEWER), rig.page(Role.VIEWER) as quick:
            text = "x" * 20_000
            for turn in range(MOST_WAITING * 2):
                rig.bus.publish(TokenGenerated(text, turn))
                assert (await quick.until("talk"))["turn"] == turn
            while rig.server.status().values["pages"] != 1:
                await asyncio.sleep(0.01)
            return (await quick.ask(type="stop"))["type"]

    assert asyncio.run(crowd()) == "ok"


def test_of_states_only_the_newest_waits() -> None:
    async def fill() -> list[str]:
        sent: list[str] = []

        class Takes:
            async def send_str(self, data: str) -> None:
                sent.append(data)

        outbox = Outbox(lambda: None)
        for number in range(1000):
            outbox.put_newest("live", f"live {number}")
        outbox.put("talk")
        outbox.put_newest("stop", "stop")
        outbox.put_unless_newer("live", "live of long ago")
        outbox.put_first("hello")
        task = asyncio.create_task(outbox.send_all(Takes()))
        while len(sent) < 4:
            await asyncio.sleep(0)
        task.cancel()
        return sent

    assert asyncio.run(fill()) == ["hello", "stop", "talk", "live 999"]


def test_pictures_wait_until_the_page_has_the_last(rig: Rig) -> None:
    async def look() -> tuple[list[bytes], int]:
        async with (
            aiohttp.ClientSession(cookies=rig.cookie(Role.VIEWER)) as client,
            client.ws_connect(rig.server.url + "/ws/view", origin=rig.server.url) as view,
        ):
            seen = []
            for _ in range(2):
                await view.send_str("ack")
                seen.append(await view.receive_bytes(timeout=WAIT_S))
            made = rig.robot.pictures
            await _stops(rig)
            return seen, rig.robot.pictures - made

    seen, more = asyncio.run(look())
    assert seen == [b"\xff\xd81", b"\xff\xd82"]
    assert more == 0
