"""Probes get through to the health and metrics ports, whoever else holds connections."""

import contextlib
import http.client
import selectors
import socket
import threading
from collections import deque
from functools import partial

import pytest

from edgevox.core.status import Components
from edgevox.ops import http_server
from edgevox.ops.health import Health, HealthServer
from edgevox.ops.http_server import MOST_AT_ONCE, MOST_BYTES, HttpServer, Page
from edgevox.ops.metrics import MetricsServer, Registry

HANG_S = 30
SMALL = Page(b"yes", "text/plain")
BIG = Page(b"x" * 50_000_000, "text/plain")
"""Fits into no buffer of the system."""


@pytest.fixture(params=["health", "metrics"])
def server(request):
    one = (
        HealthServer(Health(Components()), "127.0.0.1", 0)
        if request.param == "health"
        else MetricsServer(Registry({}), "127.0.0.1", 0)
    )
    one.start()
    yield one
    one.close()


@pytest.fixture
def pages():
    """What both servers are made of, by itself."""
    made = {"/live": lambda: SMALL, "/big": lambda: BIG}
    one = HttpServer(made, "127.0.0.1", 0, setting="port", name="pages")
    one.start()
    yield one
    one.close()


def connect(server, source="127.0.0.1"):
    return socket.create_connection(
        ("127.0.0.1", server.port), timeout=HANG_S, source_address=(source, 0)
    )


def ask(server, path="/live", meanwhile=lambda: None):
    """The status of the answer; `meanwhile`, between coming and asking."""
    path = "/metrics" if isinstance(server, MetricsServer) else path
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=HANG_S)
    with contextlib.closing(connection):
        connection.connect()
        meanwhile()
        connection.request("GET", path)
        return connection.getresponse().status


def rest_of(connection):
    """How many bytes come until it is hung up."""
    size = 0
    with contextlib.suppress(ConnectionResetError):
        while piece := connection.recv(1 << 20):
            size += len(piece)
    return size


def heard_the_end(connection):
    try:
        return connection.recv(1) == b""
    except TimeoutError:
        return False


def still_open(connection):
    connection.setblocking(False)
    try:
        return bool(connection.recv(1))
    except BlockingIOError:
        return True
    except ConnectionResetError:
        return False


class Hogs:
    """Thrice as many clients as a server holds. Who was hung up on comes back when told to."""

    def __init__(self, server, sources, words=b""):
        self._server, self._sources, self._words = server, sources, words
        self._selector = selectors.DefaultSelector()
        self._left = deque(range(3 * MOST_AT_ONCE))
        self._come(len(self._left))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()

    def come_back(self, how_many=MOST_AT_ONCE):
        """So many come, and each is let in, in the place of one that was there."""
        self._come(how_many)

    def _come(self, how_many):
        for number in [self._left.popleft() for _ in range(how_many)]:
            one = connect(self._server, self._sources[number % len(self._sources)])
            one.sendall(self._words)
            self._selector.register(one, selectors.EVENT_READ, number)
        while len(self._left) < 2 * MOST_AT_ONCE:
            hung_up_on = self._selector.select(timeout=HANG_S)
            assert hung_up_on, f"{len(self._left)} were hung up on"
            for key, _ in hung_up_on:
                self._selector.unregister(key.fileobj)
                key.fileobj.close()
                self._left.append(key.data)


@pytest.fixture
def patient(monkeypatch):
    """Nobody is hung up on for the time he takes: not a probe either, on a busy machine."""
    monkeypatch.setattr(http_server, "REQUEST_S", 2 * HANG_S)


@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize(
    ("addresses", "words"),
    [(1, b""), (7, b"G"), (7, b"GET /live HTTP/1.1\r\nX: "), (7, b"\r\n")],
)
def test_who_holds_every_connection_keeps_no_probe_from_its_answer(pages, addresses, words):
    sources = [f"127.0.1.{number + 1}" for number in range(addresses)]
    with Hogs(pages, sources, words) as hogs:
        assert {ask(pages, meanwhile=hogs.come_back) for _ in range(10)} == {200}


@pytest.mark.usefixtures("patient")
def test_they_may_come_from_two_hundred_addresses(pages):
    """Once: who then comes back while a probe asks is no worse than the probe."""
    with Hogs(pages, [f"127.0.1.{number + 1}" for number in range(200)]):
        assert {ask(pages) for _ in range(50)} == {200}


@pytest.mark.usefixtures("patient")
def test_they_may_even_come_from_the_address_of_the_probe(server):
    """Not all of them while it asks: the last of them is then no worse than the probe."""
    with Hogs(server, ["127.0.0.1"]) as hogs:
        half = partial(hogs.come_back, MOST_AT_ONCE // 2)
        assert {ask(server, meanwhile=half) for _ in range(10)} == {200}


def test_who_asks_a_byte_at_a_time_is_hung_up_on_however_long_he_goes_on(pages):
    with connect(pages) as slow:
        slow.settimeout(0.05)  # the pace of his bytes
        with contextlib.suppress(ConnectionError):
            while not heard_the_end(slow):
                slow.sendall(b"x")


def test_who_never_hears_the_answer_is_hung_up_on(pages):
    with connect(pages) as deaf:
        deaf.sendall(b"GET /big HTTP/1.1\r\n\r\n")
        assert deaf.recv(1) == b"H"
        with connect(pages) as later:
            assert later.recv(1) == b""  # his time is over, so that of the one before is, too
        assert ask(pages, "/other") == 404
        assert rest_of(deaf) < len(BIG.body)


def test_who_says_no_more_after_the_question_is_answered(server):
    path = b"/metrics" if isinstance(server, MetricsServer) else b"/live"
    with connect(server) as half:
        half.sendall(b"GET " + path + b" HTTP/1.0\r\n\r\n")
        half.shutdown(socket.SHUT_WR)
        assert half.makefile("rb").readline() == b"HTTP/1.1 200 OK\r\n"


def test_one_connection_is_one_answer(server):
    with connect(server) as one:
        one.sendall(b"GET /other HTTP/1.1\r\nConnection: keep-alive\r\n\r\n")
        told = one.makefile("rb").read()
    assert told.count(b"HTTP/1.1") == 1
    assert b"Connection: close" in told


def test_a_question_too_long_is_hung_up_on(server):
    with connect(server) as long, contextlib.suppress(OSError):
        long.sendall(b"GET /live HTTP/1.1\r\n" + b"X: x\r\n" * MOST_BYTES)
        assert long.recv(1) == b""
    assert ask(server) == 200


def test_a_crowd_takes_no_thread_and_few_files(pages):
    threads = threading.active_count()
    crowd = [connect(pages) for _ in range(3 * MOST_AT_ONCE)]
    assert ask(pages) == 200
    assert threading.active_count() == threads
    left = sum(still_open(one) for one in crowd)
    assert left <= MOST_AT_ONCE
    for one in crowd:
        one.close()
