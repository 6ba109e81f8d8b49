"""Probes get through to the health and metrics ports, whoever else holds connections."""

import contextlib
import http.client
import selectors
import socket
import threading

import pytest

from edgevox.core.status import Components
from edgevox.ops.health_checks import Health
from edgevox.ops.health_server import HealthServer
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


def ask(server, path="/live"):
    path = "/metrics" if isinstance(server, MetricsServer) else path
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=HANG_S)
    with contextlib.closing(connection):
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
    """Clients that hold `most` connections, and come back as soon as they are hung up on.

    Where each has an address of its own they come once: who then comes back while a probe is about
    to ask would be no worse than the probe, and the faster of them would win.
    """

    def __init__(self, server, most, sources, words=b""):
        self._once = len(sources) >= most
        self._server, self._sources, self._words = server, sources, words
        self._selector = selectors.DefaultSelector()
        self._over = threading.Event()
        for number in range(most):
            self._come(number)
        self._thread = threading.Thread(target=self._come_back)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()

    def _come(self, number):
        one = connect(self._server, self._sources[number % len(self._sources)])
        one.sendall(self._words)
        self._selector.register(one, selectors.EVENT_READ, number)

    def _come_back(self):
        while not self._over.is_set():
            for key, _ in self._selector.select(timeout=0.1):
                self._selector.unregister(key.fileobj)
                key.fileobj.close()
                if not self._once:
                    with contextlib.suppress(OSError):
                        self._come(key.data)


@pytest.mark.parametrize(
    ("addresses", "words"),
    [(1, b""), (200, b""), (7, b"G"), (7, b"GET /live HTTP/1.1\r\nX: "), (7, b"\r\n")],
)
def test_who_holds_every_connection_keeps_no_probe_from_its_answer(pages, addresses, words):
    sources = [f"127.0.1.{number + 1}" for number in range(addresses)]
    with Hogs(pages, 3 * MOST_AT_ONCE, sources, words):
        assert {ask(pages) for _ in range(50)} == {200}


def test_they_may_even_come_from_the_address_of_the_probe(server):
    with Hogs(server, 3 * MOST_AT_ONCE, ["127.0.0.1"]):
        assert {ask(server) for _ in range(50)} == {200}


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
