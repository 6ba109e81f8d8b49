"""The page of a fleet: what it says of each robot, and that it can do nothing to one."""

import contextlib
import http.client
import json
import re
import socket
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from guards import HUNG_S
from support.clock import HeldClock

from edgevox.apps.console_command import main
from edgevox.apps.fleet.serve import FleetRobot, FleetWatch, ask_health, fleet_server, load_fleet
from edgevox.core.errors import InvalidValue
from edgevox.core.status import Components, HealthCheck
from edgevox.ops.health import Health, HealthServer

ROOT = Path(__file__).parents[3]
A, B = FleetRobot(health="http://a:1"), FleetRobot(health="http://b:2", console="https://b")


@contextmanager
def serving(server):
    server.start()
    try:
        yield server.port
    finally:
        server.close()


def get(port: int, path: str, method: str = "GET") -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=HUNG_S)
    connection.request(method, path)
    answer = connection.getresponse()
    try:
        return answer.status, answer.read()
    finally:
        connection.close()


def test_the_example_is_a_file_that_is_taken():
    robots = load_fleet(ROOT / "examples" / "console" / "robots.yaml")
    assert list(robots) == ["kitchen", "ward"]
    assert robots["kitchen"].console == "https://robot1.local:8443"
    assert robots["ward"].console == ""


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("robots: {}", "robots"),
        ("robot: {a: {health: 'http://a:1'}}", "robot"),
        ("robots: {a: {}}", "health"),
        ("robots: {a: {health: 'a:8001'}}", "health"),
        ("robots: {a: {health: 'http://a:8001/ready'}}", "health"),
        ("robots: {a: {health: 'https://a:8001'}}", "health"),
        ("robots: {a: {health: 'http://a:99999'}}", "health"),
        ("robots: {a: {health: 'http://me:secret@a:1'}}", "health"),
        ("robots: {a: {health: 'http://a:1', console: 'javascript:alert(1)'}}", "console"),
        ("robots: {a: {health: 'http://a:1', password: x}}", "password"),
        ("robots: {'': {health: 'http://a:1'}}", "robots"),
    ],
)
def test_what_is_wrong_in_a_file_is_said_by_name(text, named, tmp_path):
    file = tmp_path / "robots.yaml"
    file.write_text(text)
    with pytest.raises(InvalidValue, match=named):
        load_fleet(file)


def test_it_says_of_each_robot_what_its_health_says():
    ill = (
        HealthCheck("battery", lambda: "", vital=False),
        HealthCheck("stt", lambda: "no model", vital=False),
    )
    health = Health(Components())
    for check in ill:
        health.add(check)
    with serving(HealthServer(health, "127.0.0.1", 0)) as port:
        robot = FleetRobot(health=f"http://127.0.0.1:{port}")
        assert ask_health(robot) == ("unwell", {"start": "starting", "stt": "no model"})


def test_a_robot_that_is_well_is_ready():
    health = Health(Components())
    health.started()
    with serving(HealthServer(health, "127.0.0.1", 0)) as port:
        assert ask_health(FleetRobot(health=f"http://127.0.0.1:{port}")) == ("ready", {})


def test_where_nobody_answers_it_is_gone():
    with socket.create_server(("127.0.0.1", 0)) as one:
        port = one.getsockname()[1]
    state, problems = ask_health(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert state == "gone"
    assert problems["network"]


@pytest.mark.parametrize(
    "body",
    [b"<html>", b"[]", b"{}", b'{"checks": 7}', b"", b"[" * 60_000, b'{"checks": {"a": 1e999}}'],
)
def test_what_is_no_health_is_no_robot(body):
    with socket.create_server(("127.0.0.1", 0)) as one:
        robot = FleetRobot(health=f"http://127.0.0.1:{one.getsockname()[1]}")
        answering = threading.Thread(target=_answer_once, args=(one, body))
        answering.start()
        state, _ = ask_health(robot)
        answering.join()
    assert state == "gone"


def test_a_robot_that_drips_its_answer_keeps_nobody_waiting():
    over = threading.Event()

    def drip(listening: socket.socket) -> None:
        client, _ = listening.accept()
        with client, contextlib.suppress(OSError):
            client.sendall(b"HTTP/1.0 200 OK\r\n")
            while not over.wait(0.1):
                client.sendall(b"x: y\r\n")

    with socket.create_server(("127.0.0.1", 0)) as one:
        robot = FleetRobot(health=f"http://127.0.0.1:{one.getsockname()[1]}")
        dripping = threading.Thread(target=drip, args=(one,))
        dripping.start()
        asking = ThreadPoolExecutor(1)
        try:
            assert asking.submit(ask_health, robot).result(HUNG_S)[0] == "gone"
        finally:
            over.set()
            dripping.join()
            asking.shutdown()


def _answer_once(listening: socket.socket, body: bytes) -> None:
    client, _ = listening.accept()
    with client:
        client.recv(4096)
        client.sendall(b"HTTP/1.0 200 OK\r\n\r\n" + body)


def test_each_robot_is_shown_with_how_long_ago_it_was_asked():
    clock = HeldClock()
    watch = FleetWatch({"a": A, "b": B}, lambda _: ("ready", {}), clock)
    assert [(one["state"], one["age_s"]) for one in watch.as_json()] == [("unknown", None)] * 2
    watch.look()
    clock.now_s += 3.0
    shown = watch.as_json()
    assert [one["name"] for one in shown] == ["a", "b"]
    assert [one["age_s"] for one in shown] == [3.0, 3.0]
    assert [one["console"] for one in shown] == ["", "https://b"]


def test_a_robot_that_does_not_answer_keeps_no_other_from_being_asked():
    b_was_asked = threading.Event()

    def ask(robot):
        if robot is A:
            assert b_was_asked.wait(HUNG_S)
            return "gone", {}
        b_was_asked.set()
        return "ready", {}

    watch = FleetWatch({"a": A, "b": B}, ask)
    watch.look()
    assert [one["state"] for one in watch.as_json()] == ["gone", "ready"]


def test_it_goes_on_asking_until_it_is_closed():
    asked = threading.Event()

    def ask(_):
        asked.set()
        return "ready", {}

    watch = FleetWatch({"a": A}, ask)
    watch.start()
    try:
        assert asked.wait(HUNG_S)
    finally:
        watch.close()


def test_the_page_shows_what_the_watch_saw_and_takes_nothing():
    watch = FleetWatch({"a": A, "b": B}, lambda _: ("unwell", {"stt": "<b>"}))
    watch.look()
    with serving(fleet_server(watch, 0)) as port:
        status, page = get(port, "/")
        assert status == 200
        assert b"default-src 'none'" in page
        for path in re.findall(r'(?:src|href)="(/[^"]*)"', page.decode()):
            assert get(port, path)[0] == 200, path
        shown = json.loads(get(port, "/robots")[1])["robots"]
        assert [one["problems"] for one in shown] == [{"stt": "<b>"}] * 2
        for method in ("POST", "PUT", "DELETE"):
            assert get(port, "/robots", method)[0] == 405


def test_the_page_writes_text_and_never_html():
    script = (ROOT / "edgevox" / "apps" / "fleet" / "page" / "fleet.js").read_text()
    assert not re.search(r"innerHTML|outerHTML|insertAdjacent|document\.write|\beval\b", script)
    assert not re.search(r"<script>|\son\w+=|style=", script)


def test_the_command_serves_the_robots_of_a_file(tmp_path):
    file = tmp_path / "robots.yaml"
    file.write_text("robots: {a: {health: 'http://127.0.0.1:1'}}")
    asked = [
        sys.executable,
        "-c",
        f"import sys; from {main.__module__} import main; sys.exit(main())",
    ]
    asked += ["--robots", str(file), "--robots-port", "0"]
    with subprocess.Popen(asked, stdout=subprocess.PIPE, text=True) as served:
        try:
            said = served.stdout.readline()
            port = int(re.fullmatch(r"1 robots on http://localhost:(\d+)\n", said)[1])
            assert [one["name"] for one in json.loads(get(port, "/robots")[1])["robots"]] == ["a"]
        finally:
            served.terminate()
        assert served.wait(HUNG_S) == 0


def test_the_command_says_what_is_wrong_with_a_file(tmp_path, capsys):
    assert main(["--robots", str(tmp_path / "gone.yaml")]) == 2
    assert "robots" in capsys.readouterr().err
