"""What strangers send is counted and not told; who was let in stays in, and who comes gets in."""

import asyncio
import json
import re
import socket
import ssl
from contextlib import AsyncExitStack, contextmanager
from pathlib import Path

import aiohttp
import pytest
from logs_rig import logging_to_memory

from edgevox.console.certificates import own_tls
from edgevox.console.door import MOST, MOST_OF_SESSION
from edgevox.console.limits import BadRequest
from edgevox.console.sessions import Role
from edgevox.ops.metric_table import BAD_REQUESTS
from tests.console_rig import WAIT_S, Rig, console

SECRET = "f00dfacef00dface.THE-SECRET-OF-SOMEBODY"  # noqa: S105 - nobody's


@contextmanager
def logged_console(folder: Path, **given):
    """A console, and all that is logged at any level while it runs."""
    with logging_to_memory(log_level="debug") as logged, console(folder, **given) as rig:
        yield rig, logged


def raw(rig: Rig, data: bytes) -> bytes:
    """What a server answers to these bytes, to its end."""
    answer = b""
    with socket.create_connection(("127.0.0.1", rig.server.port), timeout=WAIT_S) as one:
        one.sendall(data)
        one.shutdown(socket.SHUT_WR)
        try:
            while piece := one.recv(65536):
                answer += piece
        except ConnectionError:
            pass
    return answer


def request(*lines: str, body: bytes = b"", first: str = "GET / HTTP/1.1") -> bytes:
    head = "\r\n".join((first, "Host: localhost", "Connection: close", *lines))
    return head.encode("latin-1") + b"\r\n\r\n" + body


COOKIE = f"Cookie: edgevox={SECRET}"
POST = "POST /api/pair HTTP/1.1"
BAD = {
    "a cookie of nine kilobytes": request(COOKIE + "x" * 9000),
    "many headers": request(COOKIE, *(f"X-{n}: {SECRET}" for n in range(5000))),
    "a long address": request(COOKIE, first=f"GET /{SECRET}{'x' * 9000} HTTP/1.1"),
    "no version": request(COOKIE, first=f"GET /{SECRET}"),
    "no method": request(COOKIE, first=f"\x00{SECRET} / HTTP/1.1"),
    "a header without a colon": request(COOKIE, SECRET),
    "a header with a NUL": request(COOKIE, f"X: \x00{SECRET}"),
    "a length that is none": request(COOKIE, f"Content-Length: {SECRET}", first=POST),
    "two lengths": request(COOKIE, "Content-Length: 1", "Content-Length: 2", first=POST),
    "chunks that are none": request(
        COOKIE, "Transfer-Encoding: chunked", first=POST, body=SECRET.encode()
    ),
    "TLS to plain HTTP": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + SECRET.encode(),
    "nothing but noise": bytes(range(256)) * 8 + SECRET.encode(),
    "cookies that are none": request(f"Cookie: {SECRET}=\x01; edgevox={SECRET}; (=)\xff"),
    "a cookie that is no text": request(f"Cookie: edgevox={SECRET}\xff\xfe"),
    "an origin that is none": request(COOKIE, f"Origin: http://[{SECRET}", first=POST),
    "a file that cannot be": request(COOKIE, first=f"GET /static/%00{SECRET} HTTP/1.1"),
    "a way out": request(COOKIE, first=f"GET /static/../../{SECRET} HTTP/1.1"),
    "a socket that is none": request(
        COOKIE, "Upgrade: websocket", "Sec-WebSocket-Key: x", first="GET /ws HTTP/1.1"
    ),
    "a body in a code that is none": request(
        COOKIE, "Content-Type: text/plain; charset=nonsense", "Content-Length: 2", first=POST,
        body=b"{}",
    ),
    "a body that is not packed": request(
        COOKIE, "Content-Encoding: gzip", "Content-Length: 9", "Origin: http://localhost",
        first=POST, body=b"not gzip!",
    ),
    "a body that breaks off": request(
        COOKIE, "Content-Length: 99", "Origin: http://localhost", first=POST, body=b"{"
    ),
    "a body of a megabyte": request(
        COOKIE, "Content-Length: 1000000", "Origin: http://localhost", first=POST,
        body=b"x" * 1_000_000,
    ),
}  # fmt: skip


def is_quiet(text: str) -> bool:
    """Whether the log has neither a traceback nor anything that was sent."""
    return not re.search(r"Traceback|THE-SECRET|f00dface|console_broke", text)


@pytest.mark.parametrize("what", BAD)
def test_what_a_stranger_sends_leaves_no_trace_but_a_count(tmp_path, what):
    with logged_console(tmp_path) as (rig, logged):
        for _ in range(3):
            answer = raw(rig, BAD[what])
            assert b" 500 " not in answer.split(b"\r\n", 1)[0]
        assert rig.server.bad.total >= 1 or b" 404 " in answer or b" 40" in answer
        assert asyncio.run(_stops(rig))
    assert is_quiet(logged.text), logged.text


def test_a_request_that_is_no_http_is_counted_and_told_now_and_then(tmp_path):
    with logged_console(tmp_path) as (rig, logged):
        for _ in range(9):
            raw(rig, BAD["a cookie of nine kilobytes"])
        assert rig.server.bad.counts["http"] == 9
        assert rig.server.status().values["bad_requests"] == 9
    told = [line["count"] for line in logged.of("console_bad_request")]
    assert told == [1, 2, 4, 8]


def test_what_does_not_speak_tls_is_counted(tmp_path):
    with logged_console(tmp_path, tls=own_tls(tmp_path, ("localhost", "127.0.0.1"))) as (rig, log):
        for data in (
            b"GET / HTTP/1.1\r\n" + SECRET.encode(),
            b"\x16\x03\x01\x00\x01\x00",
            b"\0" * 99,
        ):
            raw(rig, data)
        context = ssl.create_default_context()  # which does not know the robot's authority
        with (
            pytest.raises(ssl.SSLError),
            socket.create_connection(("127.0.0.1", rig.server.port), timeout=WAIT_S) as one,
        ):
            context.wrap_socket(one, server_hostname="localhost")
        assert rig.server.bad.counts["tls"] >= 3
    assert is_quiet(log.text)


@pytest.mark.parametrize(
    "code", ["\ud800", "x" * 10_000, ["x"], {"x": 1}, None, 1e308, "\x1b[31m\n", "ÄÖ"]
)
def test_a_code_that_is_none_is_counted_and_lets_nobody_in(tmp_path, code):
    async def pair(rig: Rig) -> int:
        async with (
            aiohttp.ClientSession() as client,
            client.post(
                rig.server.url + "/api/pair",
                data=json.dumps({"code": code}),
                headers={"Origin": rig.server.url},
            ) as told,
        ):
            return told.status

    with logged_console(tmp_path) as (rig, logged):
        rig.server.offer_code()
        assert asyncio.run(pair(rig)) in (400, 403, 413)
        assert rig.server.sessions.all() == []
    assert is_quiet(logged.text)


@pytest.mark.parametrize("data", [b"\xff\xfe", b"{", b'{"type": "' + SECRET.encode() + b'"}'])
def test_what_is_no_message_on_a_socket_is_counted(tmp_path, data):
    async def send(rig: Rig) -> None:
        async with rig.page(Role.VIEWER) as page:
            await page.socket.send_frame(data, aiohttp.WSMsgType.TEXT)
            await page.socket.receive(timeout=WAIT_S)

    with logged_console(tmp_path) as (rig, logged):
        asyncio.run(send(rig))
        assert data == b"\xff\xfe" or rig.server.bad.counts["message"] == 1
        assert asyncio.run(_stops(rig))
    assert is_quiet(logged.text)


def test_every_kind_is_a_label_of_the_metric():
    assert tuple(BadRequest) == BAD_REQUESTS


async def _stops(rig: Rig) -> bool:
    async with rig.page(Role.VIEWER) as page:
        return (await page.ask(type="stop"))["type"] == "ok"


def test_one_browser_cannot_take_all_sockets(tmp_path):
    async def crowd(rig: Rig) -> int:
        url, cookie = rig.server.url, rig.cookie()
        async with AsyncExitStack() as stack:
            client = await stack.enter_async_context(
                aiohttp.ClientSession(cookies=cookie, connector=aiohttp.TCPConnector(limit=0))
            )
            for _ in range(MOST - 3):
                await stack.enter_async_context(client.ws_connect(f"{url}/ws", origin=url))
            held = int(rig.server.status().values["connections"])
            code, _ = rig.server.offer_code()
            headers = {"Origin": url}
            async with (
                aiohttp.ClientSession() as new,
                new.post(f"{url}/api/pair", json={"code": code.code}, headers=headers) as told,
            ):
                assert told.status == 200
            assert await _stops(rig)
            return held

    with console(tmp_path) as rig:
        assert asyncio.run(crowd(rig)) <= MOST_OF_SESSION + 1


def test_many_browsers_that_hold_all_they_may_let_a_new_one_in(tmp_path):
    async def crowd(rig: Rig) -> None:
        url = rig.server.url
        async with AsyncExitStack() as stack:
            for _ in range(MOST // MOST_OF_SESSION + 1):
                client = await stack.enter_async_context(
                    aiohttp.ClientSession(
                        cookies=rig.cookie(), connector=aiohttp.TCPConnector(limit=0)
                    )
                )
                for _ in range(MOST_OF_SESSION):
                    await stack.enter_async_context(client.ws_connect(f"{url}/ws", origin=url))
            assert await _stops(rig)

    with console(tmp_path) as rig:
        asyncio.run(crowd(rig))


def test_strangers_take_no_socket_of_who_is_let_in(tmp_path):
    async def crowd(rig: Rig) -> bool:
        async with rig.page(Role.VIEWER) as page:
            held = [
                socket.create_connection(("127.0.0.1", rig.server.port), timeout=WAIT_S)
                for _ in range(2 * MOST)
            ]
            answered = (await page.ask(type="stop"))["type"] == "ok"
            for one in held:
                one.close()
            return answered

    with console(tmp_path) as rig:
        assert asyncio.run(crowd(rig))
