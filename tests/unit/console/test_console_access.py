"""Who is let in, by what, and how that ends."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import aiohttp
import pytest

from edgevox.console.lease import GONE_S, IDLE_S, Lease
from edgevox.console.limits import PageRateLimit
from edgevox.console.sessions import CODE_LAST_S, MOST_WRONG, Pairing, Role, Sessions
from edgevox.console.sessions import LAST_S as SESSION_S
from tests.console_rig import Rig, console


class HeldClock:
    """Time in hand."""

    def __init__(self) -> None:
        self.at = 1000.0

    def now(self) -> float:
        return self.at


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with console(tmp_path) as made:
        yield made


async def _pair(client: aiohttp.ClientSession, rig: Rig, code: str, origin: str = "") -> int:
    headers = {"Origin": origin or rig.server.url}
    async with client.post(
        rig.server.url + "/api/pair", json={"code": code}, headers=headers
    ) as told:
        return told.status


def test_a_browser_is_called_as_its_person_says_and_no_two_the_same(rig: Rig) -> None:
    async def pair(name: object) -> int:
        code, _ = rig.server.offer_code()
        async with aiohttp.ClientSession(headers={"User-Agent": "Chrome Android"}) as client:
            told = {"code": code.code, "name": name}
            headers = {"Origin": rig.server.url}
            async with client.post(
                rig.server.url + "/api/pair", json=told, headers=headers
            ) as answer:
                return answer.status

    async def pair_all() -> list[int]:
        return [await pair(name) for name in ("Anna\x1b[31m  phone", "", "", "x" * 99)]

    assert asyncio.run(pair_all()) == [200] * 4
    names = [session.name for session in rig.server.sessions.all()]
    assert sorted(names) == ["Anna phone", "Chrome Android", "Chrome Android 2", "x" * 40]


def test_a_code_lets_one_browser_in_with_a_cookie_that_scripts_do_not_see(rig: Rig) -> None:
    code, address = rig.server.offer_code(Role.VIEWER)
    assert address == f"{rig.server.url}/#pair={code.code}"

    async def pair() -> tuple[str, dict[str, str], int]:
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(cookie_jar=jar) as client:
            headers = {"Origin": rig.server.url}
            async with client.post(
                rig.server.url + "/api/pair", json={"code": code.shown}, headers=headers
            ) as told:
                cookie = told.headers["Set-Cookie"]
            async with client.get(rig.server.url + "/api/me") as told:
                me = await told.json()
            return cookie, me, await _pair(client, rig, code.code)

    cookie, me, again = asyncio.run(pair())
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert me["role"] == "viewer"
    assert again == 403


def test_guessing_is_slow_and_ends_the_code(tmp_path: Path) -> None:
    pairing = Pairing(tmp_path)
    code = pairing.offer()
    assert [pairing.redeem("AAAA-AAAA") for _ in range(MOST_WRONG)] == [None] * MOST_WRONG
    assert pairing.redeem(code.code) is None
    with console(tmp_path) as rig:

        async def guess() -> list[int]:
            async with aiohttp.ClientSession() as client:
                return [await _pair(client, rig, "AAAA-AAAA") for _ in range(6)]

        assert asyncio.run(guess()) == [403] * 5 + [429]


def test_a_code_is_worth_nothing_after_some_minutes(tmp_path: Path) -> None:
    clock = HeldClock()
    pairing = Pairing(tmp_path, clock.now)
    code = pairing.offer()
    clock.at += CODE_LAST_S
    assert pairing.redeem(code.code) is None


@pytest.mark.parametrize("origin", ["https://evil.example", "null", ""])
def test_another_sites_page_gets_nowhere(rig: Rig, origin: str) -> None:
    code, _ = rig.server.offer_code()

    async def knock() -> list[int]:
        headers = {"Origin": origin} if origin else {}
        found = []
        async with aiohttp.ClientSession(cookies=rig.cookie()) as client:
            for path in ("/ws", "/ws/view"):
                with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                    await client.ws_connect(rig.server.url + path, headers=headers)
                found.append(refused.value.status)
            async with client.post(
                rig.server.url + "/api/pair", json={"code": code.code}, headers=headers
            ) as told:
                found.append(told.status)
        return found

    assert asyncio.run(knock()) == [403, 403, 403]


@pytest.mark.parametrize("cookie", ["", "x", "../../etc/passwd.y", "0123456789abcdef.wrong"])
def test_without_a_session_there_is_nothing(rig: Rig, cookie: str) -> None:
    async def knock() -> int:
        async with aiohttp.ClientSession(cookies={"edgevox": cookie}) as client:
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await client.ws_connect(rig.server.url + "/ws", origin=rig.server.url)
            return refused.value.status

    assert asyncio.run(knock()) == 401


def test_a_session_that_is_revoked_is_hung_up_on_and_commands_nothing(rig: Rig) -> None:
    cookie = rig.cookie()

    async def revoke() -> int | None:
        async with rig.page(cookie=cookie) as page:
            await page.ask(type="lease", action="take")
            assert rig.server.sessions.revoke(cookie["edgevox"].partition(".")[0])
            await page.send(type="text", text="go to the kitchen")
            return await page.closed()

    assert asyncio.run(revoke()) == 4401
    assert rig.submitted == []


def test_a_page_that_says_nothing_is_hung_up_on_too_when_it_is_revoked(rig: Rig) -> None:
    cookie = rig.cookie()

    async def revoke() -> int | None:
        async with rig.page(cookie=cookie) as page:
            rig.server.sessions.revoke(cookie["edgevox"].partition(".")[0])
            return await page.closed()

    assert asyncio.run(revoke()) == 4401


def test_the_secret_is_not_on_the_disk_and_a_session_ends(tmp_path: Path) -> None:
    clock = HeldClock()
    sessions = Sessions(tmp_path, clock.now)
    session, cookie = sessions.begin(Role.OPERATOR, "phone", "10.0.0.1")
    (file,) = (tmp_path / "sessions").iterdir()
    assert cookie.partition(".")[2] not in file.read_text()
    assert file.stat().st_mode & 0o777 == 0o600
    assert sessions.of_cookie(cookie) == session
    clock.at += SESSION_S
    assert sessions.of_cookie(cookie) is None
    assert not sessions.is_there(session)
    assert sessions.all() == []


def test_the_lease_is_taken_back_from_who_is_away_or_idle() -> None:
    clock = HeldClock()
    lease = Lease(clock)
    assert lease.take("a")
    lease.request("b")
    clock.at += IDLE_S - 1
    lease.used("a")
    clock.at += IDLE_S - 1
    lease.tick()
    assert lease.state.holder == "a"
    clock.at += 1
    lease.tick()
    assert (lease.state.holder, lease.state.waiting) == ("b", ())
    lease.gone("b")
    lease.came("b")
    clock.at += GONE_S
    lease.tick()
    assert lease.state.holder == "b"
    lease.gone("b")
    clock.at += GONE_S
    lease.tick()
    assert lease.state.holder is None


def test_a_limit_lets_a_burst_through_and_then_so_many_a_second() -> None:
    clock = HeldClock()
    limit = PageRateLimit(clock, 2, 3)
    assert [limit.allows("a") for _ in range(4)] == [True, True, True, False]
    assert limit.allows("b")
    clock.at += 0.5
    assert [limit.allows("a") for _ in range(2)] == [True, False]


def test_every_answer_tells_the_browser_what_to_forbid(rig: Rig) -> None:
    async def ask() -> list[str]:
        async with aiohttp.ClientSession() as client:
            found = []
            for path in ("/", "/api/me", "/nowhere"):
                async with client.get(rig.server.url + path) as told:
                    found.append(told.headers["Content-Security-Policy"])
            return found

    for policy in asyncio.run(ask()):
        assert policy.startswith("default-src 'none'; script-src 'self'")
        assert "unsafe" not in policy


def test_whoever_is_revoked_sees_no_more_pictures(rig: Rig) -> None:
    cookie = rig.cookie()

    async def look() -> tuple[bool, int | None]:
        async with (
            aiohttp.ClientSession(cookies=cookie) as client,
            client.ws_connect(rig.server.url + "/ws/view", origin=rig.server.url) as view,
        ):
            await view.send_str("ack")
            await view.receive_bytes(timeout=30)
            rig.server.sessions.revoke(cookie["edgevox"].partition(".")[0])
            await view.send_str("ack")
            told = await view.receive(timeout=30)
            return told.type is aiohttp.WSMsgType.BINARY, view.close_code

    assert asyncio.run(look()) == (False, 4401)


def test_of_two_at_once_with_one_code_one_is_let_in(rig: Rig) -> None:
    code, _ = rig.server.offer_code()

    async def pair() -> list[int]:
        async with aiohttp.ClientSession() as client:
            return await asyncio.gather(*(_pair(client, rig, code.code) for _ in range(4)))

    assert sorted(asyncio.run(pair())) == [200, 403, 403, 403]
    assert len(rig.server.sessions.all()) == 1
