"""What passes on the socket for sound, with a real client: who is heard, and what is dropped."""

import asyncio
import json
import struct
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import aiohttp
import numpy as np
import pytest
from support.clock import HeldClock

from edgevox.console.page_hub import SLOW
from edgevox.console.sessions import Role
from edgevox.console.sockets.browser_sound import Lateness, SoundQueue
from tests.console_rig import WAIT_S, Rig, console

SILENCE = bytes(640)
Asked = tuple[str, ...] | tuple[str, bool]


class NotedSound:
    """Ears and a mouth that note what is asked of them."""

    def __init__(self) -> None:
        self.asked: list[Asked] = []
        self.pushed: list[int] = []
        self.changed = threading.Condition()
        self.busy = False
        self.hears: list[tuple[Callable[[int, bytes], None], Callable[[], None]]] = []

    def open(self, client: str, *, held: bool) -> bool:
        self._note(("open", held))
        return not self.busy

    def close(self, client: str) -> None:
        self._note(("close",))

    def abandon(self, client: str) -> None:
        self._note(("abandon",))

    def push(self, client: str, samples: np.ndarray) -> None:
        with self.changed:
            assert samples.dtype == np.int16
            assert samples.shape == (320,)
            self.pushed.append(int(samples[0]))
            self.changed.notify_all()

    def listen(
        self, callback: Callable[[int, bytes], None], on_flush: Callable[[], None]
    ) -> Callable[[], None]:
        with self.changed:
            one = (callback, on_flush)
            self.hears.append(one)
            self.changed.notify_all()
        return lambda: self.hears.remove(one)

    def wait(self, true: Callable[[], object]) -> None:
        with self.changed:
            assert self.changed.wait_for(true, WAIT_S), (self.asked, self.pushed)

    def _note(self, asked: Asked) -> None:
        with self.changed:
            self.asked.append(asked)
            self.changed.notify_all()


@pytest.fixture
def sound() -> NotedSound:
    return NotedSound()


@pytest.fixture
def rig(tmp_path: Path, sound: NotedSound) -> Iterator[Rig]:
    with console(tmp_path, clock=HeldClock(1000.0), sound=sound) as made:
        yield made


@asynccontextmanager
async def line(
    rig: Rig, role: Role = Role.OPERATOR, *, lease: bool = True
) -> AsyncIterator["Line"]:
    cookie = rig.cookie(role)
    async with rig.page(cookie=cookie) as page:
        if lease and role is Role.OPERATOR:
            assert (await page.ask(type="lease", action="take"))["type"] == "ok"
        url = rig.server.url
        async with (
            aiohttp.ClientSession(cookies=cookie) as client,
            client.ws_connect(url + "/ws/sound", origin=url) as socket,
        ):
            yield Line(socket, page)


class Line:
    def __init__(self, socket: aiohttp.ClientWebSocketResponse, page: object) -> None:
        self.socket, self.page, self.sent = socket, page, 0

    async def ask(self, **message: object) -> str:
        await self.socket.send_str(json.dumps(message))
        return str((await self.socket.receive_json(timeout=WAIT_S))["state"])

    async def say(self, level: int, at_ms: int = 0) -> None:
        self.sent += 1
        samples = np.full(320, level, "<i2").tobytes()
        await self.socket.send_bytes(struct.pack("<II", self.sent, at_ms) + samples)


async def waited(sound: NotedSound, true: Callable[[], object]) -> None:
    await asyncio.to_thread(sound.wait, true)


def test_who_holds_the_lease_is_heard_while_the_button_is_held(rig: Rig, sound: NotedSound) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            await one.say(1)  # nobody holds the button yet
            assert await one.ask(type="talk", held=True) == "held"
            await one.say(2)
            await one.say(3)
            assert await one.ask(type="talk", held=False) == "closed"
            await one.say(4)
            assert await one.ask(type="talk", held=True) == "held"

    asyncio.run(talk())
    assert sound.pushed == [2, 3]
    assert sound.asked[:3] == [("open", True), ("close",), ("open", True)]


def test_what_was_being_said_does_not_count_when_the_line_breaks(
    rig: Rig, sound: NotedSound
) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            await one.ask(type="talk", held=True)
            await one.say(2)

    asyncio.run(talk())
    sound.wait(lambda: ("abandon",) in sound.asked)
    assert ("close",) not in sound.asked


def test_the_open_microphone_is_not_held_and_shutting_it_forgets_what_was_said(
    rig: Rig, sound: NotedSound
) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            assert await one.ask(type="open", on=True) == "open"
            assert await one.ask(type="talk", held=True) == "held"
            assert await one.ask(type="talk", held=False) == "open"
            assert await one.ask(type="open", on=False) == "closed"

    asyncio.run(talk())
    assert sound.asked == [("open", False), ("open", True), ("open", False), ("abandon",)]


@pytest.mark.parametrize(("role", "lease"), [(Role.VIEWER, True), (Role.OPERATOR, False)])
def test_who_may_not_command_is_not_heard(
    rig: Rig, sound: NotedSound, role: Role, lease: bool
) -> None:
    async def talk() -> None:
        async with line(rig, role, lease=lease) as one:
            assert await one.ask(type="talk", held=True) == "busy"
            await one.say(1)
            assert await one.ask(type="open", on=True) == "busy"

    asyncio.run(talk())
    assert sound.pushed == []
    assert sound.asked == []


def test_who_gives_the_lease_away_is_heard_no_longer(rig: Rig, sound: NotedSound) -> None:
    async def talk() -> None:
        async with line(rig) as one, rig.page() as other:
            await one.ask(type="open", on=True)
            await other.ask(type="lease", action="request")
            await one.page.ask(type="lease", action="give")
            await one.say(5)
            told = await one.socket.receive_json(timeout=WAIT_S)
            assert told == {"type": "state", "state": "busy"}

    asyncio.run(talk())
    assert sound.pushed == []
    assert sound.asked == [("open", False), ("abandon",)]


def test_one_who_speaks_keeps_others_waiting(rig: Rig, sound: NotedSound) -> None:
    sound.busy = True

    async def talk() -> str:
        async with line(rig) as one:
            return await one.ask(type="talk", held=True)

    assert asyncio.run(talk()) == "busy"


def test_sound_that_comes_late_is_not_taken(rig: Rig, sound: NotedSound) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            await one.ask(type="talk", held=True)
            await one.say(1, at_ms=2**32 - 60_000)
            await one.say(2, at_ms=2**32 - 60_500)  # said half a second before, and comes after it
            await one.say(3, at_ms=2**32 - 60_000)
            await waited(sound, lambda: 3 in sound.pushed)

    asyncio.run(talk())
    assert sound.pushed == [1, 3]


@pytest.mark.parametrize("pressed", ["before", "in"])
def test_a_hole_ends_the_line_and_what_was_said_at_it_does_not_count(
    rig: Rig, sound: NotedSound, pressed: str
) -> None:
    async def talk() -> int | None:
        async with line(rig) as one:
            await one.ask(type="talk", held=True)
            await one.say(1, at_ms=60_000)
            if pressed == "in":
                await one.ask(type="talk", held=False)
                await one.ask(type="talk", held=True)
            for at_ms in (55_000, 55_020):  # held back by the line for five seconds
                await one.say(2, at_ms=at_ms)
            await one.socket.send_str('{"type": "talk", "held": false}')
            await one.socket.receive(timeout=WAIT_S)
            return one.socket.close_code

    assert asyncio.run(talk()) == SLOW
    assert sound.pushed == [1]
    assert sound.asked[-1] == ("abandon",)


@pytest.mark.parametrize("data", [b"", bytes(8), bytes(647), bytes(649)])
def test_a_frame_of_another_size_is_not_taken(rig: Rig, sound: NotedSound, data: bytes) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            await one.ask(type="talk", held=True)
            await one.socket.send_bytes(data)
            await one.say(7)
            await waited(sound, lambda: sound.pushed)

    asyncio.run(talk())
    assert sound.pushed == [7]


def test_a_long_message_ends_the_line(rig: Rig, sound: NotedSound) -> None:
    async def talk() -> int | None:
        async with line(rig) as one:
            await one.socket.send_bytes(bytes(5000))
            await one.socket.receive(timeout=WAIT_S)
            return one.socket.close_code

    assert asyncio.run(talk()) == aiohttp.WSCloseCode.MESSAGE_TOO_BIG


def test_a_flood_ends_the_line(rig: Rig) -> None:
    async def talk() -> int | None:
        async with line(rig) as one:
            try:
                for _ in range(20_000):
                    await one.say(0)
            except (ConnectionError, aiohttp.ClientError):
                pass
            while not one.socket.closed:
                await one.socket.receive(timeout=WAIT_S)
            return one.socket.close_code

    assert asyncio.run(talk()) == 4429


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"type": "talk", "held": 1}', "x" * 500])
def test_words_that_mean_nothing_are_answered_and_the_line_goes_on(
    rig: Rig, sound: NotedSound, text: str
) -> None:
    async def talk() -> None:
        async with line(rig) as one:
            await one.socket.send_str(text)
            assert (await one.socket.receive_json(timeout=WAIT_S))["state"] == "failed"
            assert await one.ask(type="talk", held=True) == "held"

    asyncio.run(talk())


def test_who_wants_to_hears_the_robot_and_is_told_when_it_falls_silent(
    rig: Rig, sound: NotedSound
) -> None:
    async def hear() -> list[bytes]:
        async with line(rig, Role.VIEWER) as one:
            await one.socket.send_str(json.dumps({"type": "hear", "on": True}))
            await waited(sound, lambda: sound.hears)
            callback, flush = sound.hears[0]
            callback(7, bytes(range(256)) * 5)
            first = [await one.socket.receive_bytes(timeout=WAIT_S) for _ in range(2)]
            flush()
            return [*first, await one.socket.receive_bytes(timeout=WAIT_S)]

    first, second, flush = asyncio.run(hear())
    assert struct.unpack("<BII", first[:9]) == (0, 7, 1_000_000)
    assert first[9:] + second[9:] == bytes(range(256)) * 5
    assert struct.unpack("<BII", flush) == (1, 7, 1_000_000)
    sound.wait(lambda: not sound.hears)


def test_a_browser_that_is_thrown_out_hears_nothing_more(rig: Rig, sound: NotedSound) -> None:
    async def hear() -> int | None:
        async with line(rig, Role.VIEWER) as one:
            await one.socket.send_str(json.dumps({"type": "hear", "on": True}))
            await waited(sound, lambda: sound.hears)
            (session,) = rig.server.sessions.all()
            rig.server.sessions.revoke(session.id)
            while not one.socket.closed:
                await one.socket.receive(timeout=WAIT_S)
            return one.socket.close_code

    assert asyncio.run(hear()) == 4401
    assert not sound.hears


def test_another_pages_socket_is_refused(rig: Rig) -> None:
    async def knock() -> int:
        async with aiohttp.ClientSession(cookies=rig.cookie()) as client:
            url = rig.server.url + "/ws/sound"
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await client.ws_connect(url, origin="https://elsewhere.example")
            return refused.value.status

    assert asyncio.run(knock()) == 403


class SlowPage:
    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.done = asyncio.Event()

    async def send_bytes(self, data: bytes) -> None:
        self.sent.append(data)
        self.done.set()

    async def send_str(self, data: str) -> None: ...


def test_speech_that_waited_too_long_is_not_sent() -> None:
    async def send() -> list[bytes]:
        clock, page = HeldClock(10.0), SlowPage()
        queue = SoundQueue(clock, 0.2)
        queue.put(1, b"old")
        clock.now_s += 0.3
        queue.put(2, b"new")
        task = asyncio.create_task(queue.send_all(page))
        await page.done.wait()
        task.cancel()
        return page.sent

    (sent,) = asyncio.run(send())
    assert sent[9:] == b"new"


def test_a_page_that_lags_behind_the_most_prompt_is_late_and_clocks_may_part_slowly() -> None:
    late = Lateness()
    assert late.of(1000, 500) == 0
    assert late.of(1320, 520) == pytest.approx(300, abs=1)
    assert late.of(1340, 840) == pytest.approx(0, abs=1)
    assert late.of(3_601_340, 3_600_340) == 0  # an hour later, a clock half a second slower


def test_the_milliseconds_of_a_page_may_start_over() -> None:
    late = Lateness()
    assert late.of(1000, 2**32 - 10) == 0
    assert late.of(1020, 10) == pytest.approx(0, abs=1)
