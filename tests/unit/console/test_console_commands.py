"""What pages ask for reaches the robot: the stop at once, the rest in turn and by those who may."""

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import aiohttp
import pytest

from edgevox.console import page_hub
from edgevox.console.outbox import MOST_WAITING, Outbox
from edgevox.console.sessions import Role
from edgevox.core.agent_events import GoalRejected
from edgevox.core.commands import TextInput, Way
from edgevox.core.errors import InvalidValue
from edgevox.core.events import TokenGenerated
from edgevox.core.reason import Reason
from tests.console_rig import WAIT_S, Rig, console


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with console(tmp_path) as made:
        yield made


def test_a_page_is_greeted_with_who_it_is_and_what_there_is(rig: Rig) -> None:
    async def look() -> dict[str, object]:
        async with rig.page(Role.VIEWER) as page:
            return page.hello

    hello = asyncio.run(look())
    assert hello["protocol"] == 1
    assert hello["robot"] == "apartment"
    assert hello["role"] == "viewer"
    assert hello["stop"] == {"engaged": False, "by": "", "since": None}
    assert hello["lease"] == {"holder": None, "name": "", "mine": False, "waiting": []}
    assert hello["controls"]["language"] == "en"


def test_a_viewer_stops_without_a_lease_on_the_loops_thread_and_all_are_told(rig: Rig) -> None:
    async def press() -> dict[str, object]:
        async with rig.page(Role.VIEWER) as presses, rig.page() as other:
            assert (await presses.ask(type="stop"))["type"] == "ok"
            return await other.until("stop")

    told = asyncio.run(press())
    assert told["engaged"] is True
    assert rig.stop.pressed == [("phone", "console")]


def test_a_stop_does_not_wait_for_what_was_asked_before_and_that_is_no_longer_done(
    rig: Rig,
) -> None:
    async def press() -> list[dict[str, object]]:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            rig.hold.clear()
            await page.send(type="text", text="go to the kitchen")
            assert await asyncio.to_thread(rig.began.wait, WAIT_S)
            late = await page.send(type="text", text="and to the bedroom")
            await page.send(type="stop")
            assert await asyncio.to_thread(rig.stop.engaged.wait, WAIT_S)
            assert rig.submitted == []
            rig.hold.set()
            told = [await page.until("error")]
            assert told[0]["reply_to"] == late
            return told

    (refused,) = asyncio.run(press())
    assert refused["reason"] == "stopped"
    assert rig.submitted == [TextInput("go to the kitchen", Way.CONSOLE_OPERATOR)]


def test_commands_need_an_operator_and_the_lease(rig: Rig) -> None:
    async def ask() -> list[str]:
        text = {"type": "text", "text": "hello"}
        async with rig.page(Role.VIEWER) as viewer, rig.page() as one, rig.page() as two:
            told = [await viewer.ask(**text), await viewer.ask(type="lease", action="take")]
            told += [await one.ask(**text), await one.ask(type="lease", action="take")]
            told += [await one.ask(**text), await two.ask(**text)]
            told += [await two.ask(type="lease", action="take"), await two.ask(type="resume")]
            return [one.get("reason", "ok") for one in told]

    assert asyncio.run(ask()) == [
        "viewer", "viewer", "no_lease", "ok", "ok", "no_lease", "no_lease", "no_lease",
    ]  # fmt: skip
    assert rig.submitted == [TextInput("hello", Way.CONSOLE_OPERATOR)]


def test_the_lease_is_asked_for_and_given(rig: Rig) -> None:
    async def give() -> dict[str, object]:
        async with rig.page() as one, rig.page() as two:
            await one.ask(type="lease", action="take")
            await two.ask(type="lease", action="request")
            while not (told := await one.until("lease"))["waiting"]:
                pass
            waits = told["waiting"][0]["client"]
            assert (await one.ask(type="lease", action="give", to=waits))["type"] == "ok"
            return await two.ask(type="text", text="hello")

    assert asyncio.run(give())["type"] == "ok"


def test_who_asked_for_the_lease_may_ask_no_longer(rig: Rig) -> None:
    async def ask() -> dict[str, object]:
        async with rig.page() as one, rig.page() as two:
            await one.ask(type="lease", action="take")
            await two.ask(type="lease", action="request")
            while not (told := await one.until("lease"))["waiting"]:
                pass
            await two.ask(type="lease", action="withdraw")
            while (told := await one.until("lease"))["waiting"]:
                pass
            return told

    assert asyncio.run(ask())["mine"] is True


def test_what_is_driven_is_halted_once_when_it_is_released(rig: Rig) -> None:
    async def drive() -> None:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            await page.ask(type="drive", linear=0.2, angular=0)
            await page.ask(type="drive", linear=0, angular=0)
            await page.ask(type="drive", linear=0, angular=0)

    asyncio.run(drive())
    assert rig.robot.steered == [(0.2, 0.0), "halt"]


@pytest.mark.parametrize("how", ["silence", "closed", "given"])
def test_what_is_driven_is_halted_when_its_page(rig: Rig, how: str) -> None:
    async def drive() -> None:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            await page.ask(type="drive", linear=0.2, angular=0.1)
            if how == "given":
                await page.ask(type="lease", action="give")
            if how != "closed":
                assert await asyncio.to_thread(rig.robot.halted.wait, WAIT_S)
        assert await asyncio.to_thread(rig.robot.halted.wait, WAIT_S)

    asyncio.run(drive())
    assert rig.robot.steered == [(0.2, 0.1), "halt"]


def test_of_two_tabs_of_a_browser_one_drives_until_it_lets_go(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_hub, "HEARTBEAT_S", 600.0)

    async def drive() -> list[str]:
        cookie = rig.cookie()
        async with rig.page(cookie=cookie) as one, rig.page(cookie=cookie) as two:
            await one.ask(type="lease", action="take")
            told = [
                await one.ask(type="drive", linear=0.2, angular=0),
                await two.ask(type="drive", linear=-0.2, angular=0),
                await two.ask(type="drive", linear=0, angular=0),  # lets go of nothing
                await one.ask(type="drive", linear=0.2, angular=0),
                await one.ask(type="drive", linear=0, angular=0),
                await two.ask(type="drive", linear=-0.2, angular=0),
            ]
            await two.ask(type="drive", linear=0, angular=0)
            return [one.get("reason", "") for one in told]

    assert asyncio.run(drive()) == ["", "busy", "", "", "", ""]
    assert rig.robot.steered == [(0.2, 0.0), (0.2, 0.0), "halt", (-0.2, 0.0), "halt"]


def test_nothing_is_driven_while_stopped(rig: Rig) -> None:
    async def drive() -> list[str]:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            await page.ask(type="stop")
            refused = await page.ask(type="drive", linear=0.2, angular=0)
            await page.ask(type="resume")
            done = await page.ask(type="drive", linear=0.2, angular=0)
            return [refused.get("reason", ""), done["type"]]

    assert asyncio.run(drive()) == ["stopped", "ok"]
    assert rig.robot.refused == [(0.2, 0.0)], "a stick that is held has not paused"


def test_what_is_wrong_is_answered_with_its_field(rig: Rig) -> None:
    async def ask() -> dict[str, object]:
        async with rig.page() as page:
            await page.socket.send_str('{"id": 1, "type": "goto", "x": "far", "y": 1}')
            return await page.until("error")

    told = asyncio.run(ask())
    assert told["reason"] == "invalid"
    assert told["field"] == "x"


def test_the_conversation_and_the_state_are_told_to_those_who_look(rig: Rig) -> None:
    async def look() -> None:
        async with rig.page(Role.VIEWER) as page:
            await page.ask(type="look", what=["live", "status"])
            assert (await page.until("live"))["pose"]["x"] == 1.0
            assert (await page.until("status"))["health"]["ready"] is True
            threading.Thread(target=rig.bus.publish, args=(TokenGenerated("hi", 3),)).start()
            told = await page.until("talk")
            assert (told["kind"], told["text"], told["turn"]) == ("token", "hi", 3)
            await page.send(type="ping", t=1.5)
            assert (await page.until("pong"))["t"] == 1.5

    asyncio.run(look())


@pytest.mark.parametrize("text", ['{"type":"stop"}', '{"type":"stop","id":-1,"why":"hurry"}'])
def test_a_stop_is_taken_however_it_is_said(rig: Rig, text: str) -> None:
    async def press() -> None:
        async with rig.page(Role.VIEWER) as page:
            await page.socket.send_str(text)
            await page.until("ok")

    asyncio.run(press())
    assert rig.stop.state.engaged


def test_a_drive_that_breaks_is_halted(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_linear_m_s: float, _angular_rad_s: float) -> None:
        raise RuntimeError("half begun")

    monkeypatch.setattr(rig.robot, "drive", broken)

    async def drive() -> dict[str, object]:
        async with rig.page() as page:
            await page.ask(type="lease", action="take")
            return await page.ask(type="drive", linear=0.2, angular=0)

    assert asyncio.run(drive())["reason"] == "failed"
    assert rig.robot.steered == ["halt"]


def test_a_stop_that_breaks_halts_the_robot_all_the_same(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_who: str) -> None:
        raise RuntimeError("no interlock")

    monkeypatch.setattr(rig.stop, "stop", broken)

    async def press() -> dict[str, object]:
        async with rig.page(Role.VIEWER) as page:
            return await page.ask(type="stop")

    assert asyncio.run(press())["reason"] == "failed"
    assert rig.robot.steered == ["halt"]


def test_a_page_may_stop_before_it_was_greeted(tmp_path: Path) -> None:
    knows = threading.Event()

    def describe(_language: str) -> dict[str, object]:
        assert knows.wait(WAIT_S)
        return {}

    with console(tmp_path, describe=describe) as rig:

        async def press() -> None:
            url = rig.server.url
            async with (
                aiohttp.ClientSession(cookies=rig.cookie(Role.VIEWER)) as client,
                client.ws_connect(url + "/ws", origin=url) as socket,
            ):
                await socket.send_str('{"id": 1, "type": "stop"}')
                assert await asyncio.to_thread(rig.stop.engaged.wait, WAIT_S)
                knows.set()
                hello = await socket.receive_json(timeout=WAIT_S)
                assert hello["type"] == "hello"
                assert hello["stop"]["engaged"]

        asyncio.run(press())


def test_a_line_of_the_log_comes_to_who_looks_and_to_nobody_else(tmp_path: Path) -> None:
    tells: list[Callable[[Mapping[str, Any]], None]] = []
    ended = threading.Event()

    def follow(tell: Callable[[Mapping[str, Any]], None]) -> Callable[[], None]:
        tells.append(tell)
        return ended.set

    async def look(rig: Rig) -> tuple[dict[str, Any], dict[str, Any]]:
        async with rig.page(Role.VIEWER) as looks, rig.page() as other:
            await looks.ask(type="look", what=["log"])
            tells[0]({"level": "info", "event": "answered", "turn": 3, "text": "cut=False"})
            line = await looks.until("log")
            rig.bus.publish(TokenGenerated("after it", 3))
            return line, await other.until("log", "talk")

    with console(tmp_path, follow_log=follow) as rig:
        line, of_the_other = asyncio.run(look(rig))
    assert line == {
        "type": "log",
        "level": "info",
        "event": "answered",
        "turn": 3,
        "text": "cut=False",
    }
    assert of_the_other["type"] == "talk"
    assert ended.is_set()


def test_a_slow_page_does_without_lines_of_the_log_and_is_not_hung_up_on() -> None:
    async def flood() -> int:
        hung_up: list[bool] = []
        outbox = Outbox(lambda: hung_up.append(True))
        for _ in range(10 * MOST_WAITING):
            outbox.put_if_room("a line")
        outbox.put("what must not be left out")
        return len(hung_up)

    assert asyncio.run(flood()) == 0


def test_why_something_was_refused_is_told_each_page_in_its_own_language(tmp_path: Path) -> None:
    def explain(why: object, language: str) -> str:
        return f"{language}: {why}"

    def cannot(_: object, __: object) -> None:
        raise InvalidValue("skill", "fly", "one that there is")

    async def ask(rig: Rig) -> None:
        async with rig.page() as english, rig.page(Role.VIEWER, language="de") as german:
            rig.bus.publish(GoalRejected("fly", "{}", Reason("no wings")))
            assert (await english.until("event"))["why"] == "en: no wings"
            assert (await german.until("event"))["why"] == "de: no wings"
            await english.ask(type="lease", action="take")
            told = await english.ask(type="skill", name="fly")
            assert told["why"] == "en: skill: got 'fly', expected one that there is"

    with console(tmp_path, explain=explain, submit=cannot) as rig:
        asyncio.run(ask(rig))
