"""The page of a fleet: what it says of each robot, and that it can do nothing to one."""

import asyncio
import contextlib
import http.client
import json
import re
import socket
import ssl
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import aiohttp
import pytest
from guards import HUNG_S
from support.clock import HeldClock

from edgevox import __version__
from edgevox.apps.console_command import main
from edgevox.apps.fleet.serve import fleet_server
from edgevox.apps.fleet.watch import (
    FleetRobot,
    FleetWatch,
    LastSeen,
    RobotStatus,
    ask_robot,
    load_fleet,
)
from edgevox.console.sessions import Role
from edgevox.core.errors import InvalidValue
from edgevox.core.status import Components, Finding, HealthCheck, Level, Status
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


def get(port: int, path: str, method: str = "GET", **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=HUNG_S)
    connection.request(method, path, headers=headers)
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
        seen = ask_robot(robot)
    assert (seen.state, seen.problems) == ("unwell", {"start": "starting", "stt": "no model"})
    assert seen.told.version == __version__


def test_a_robot_that_is_well_is_ready():
    health = Health(Components())
    health.started()
    with serving(HealthServer(health, "127.0.0.1", 0)) as port:
        seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert (seen.state, seen.problems) == ("ready", {})


class Part:
    """A component with this status."""

    checks = ()

    def __init__(self, status: Status) -> None:
        self.name, self._status = status.name, status

    def status(self) -> Status:
        return self._status


def robot_of(*statuses: Status) -> Health:
    health = Health(Components(*map(Part, statuses)))
    health.started()
    return health


def test_it_tells_version_image_disk_recorder_stop_and_battery(monkeypatch):
    monkeypatch.setenv("EDGEVOX_IMAGE", "edgevox-ros2:7")
    low = [Finding(Level.WARN, "battery at 9 %")]
    disks = {"/ free_mib": 900, "/data free_mib": 4000}
    health = robot_of(
        Status.judged("sim", low, battery=0.09),
        Status.judged("interlock", engaged=True),
        Status.judged("disk", **disks),
        Status.judged("recordings", recording=True),
        Status.judged("process", [Finding(Level.WARN, "said by /ready")]),
    )
    with serving(HealthServer(health, "127.0.0.1", 0)) as port:
        seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert (seen.state, seen.problems) == ("warned", {"sim": "battery at 9 %"})
    told = RobotStatus(__version__, "edgevox-ros2:7", True, 0.09, 900.0, recording=True)
    assert seen.told == told


def test_a_recorder_of_its_own_is_asked_too():
    losing = [Finding(Level.WARN, "the upload fails")]
    recorder = robot_of(Status.judged("recorder", losing))
    with (
        serving(HealthServer(robot_of(), "127.0.0.1", 0)) as port,
        serving(HealthServer(recorder, "127.0.0.1", 0)) as beside,
    ):
        health, other = (f"http://127.0.0.1:{one}" for one in (port, beside))
        seen = ask_robot(FleetRobot(health=health, recorder=other))
    assert (seen.state, seen.problems) == ("warned", {"recorder": "the upload fails"})
    assert seen.told.recording is True


def test_a_recorder_that_the_robot_hears_is_told_by_the_robot():
    behind = [Finding(Level.WARN, "nothing was uploaded")]
    health = robot_of(
        Status.judged("recordings", recording=False),
        Status.judged("recorder", behind, recording=True),
    )
    with serving(HealthServer(health, "127.0.0.1", 0)) as port:
        seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert (seen.state, seen.problems) == ("warned", {"recorder": "nothing was uploaded"})
    assert seen.told.recording is True


@pytest.mark.parametrize(
    "body",
    [
        b"[]",
        b"{}",
        b'{"components": [{"name": "sim"}]}',
        b'{"components": [{"name": [], "level": 1, "message": "", "values": 7}, 3]}',
        b'{"components": [{"name": "sim", "level": 0, "message": "", "values": []}]}',
    ],
)
def test_a_robot_whose_status_is_nonsense_is_still_told(body):
    ready = b'{"checks": {"start": "ok"}}'
    with answering_in_turn(ready, body) as port:
        seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert seen.state == "warned"
    assert list(seen.problems) == ["status"]


def test_values_of_another_kind_count_as_not_told():
    values = b'{"battery": "<b>", "engaged": 7}'
    parts = b'{"name": "sim", "level": 0, "message": "", "values": %b}' % values
    body = b'{"version": 3, "image": [], "components": [%b]}' % parts
    with answering_in_turn(b'{"checks": {}}', body) as port:
        seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert (seen.state, seen.told) == ("ready", RobotStatus())


@contextmanager
def answering_in_turn(*bodies: bytes):
    with socket.create_server(("127.0.0.1", 0)) as one:

        def answer() -> None:
            for body in bodies:
                _answer_once(one, body)

        answers = threading.Thread(target=answer)
        answers.start()
        yield one.getsockname()[1]
        answers.join()


def test_where_nobody_answers_it_is_gone():
    with socket.create_server(("127.0.0.1", 0)) as one:
        port = one.getsockname()[1]
    seen = ask_robot(FleetRobot(health=f"http://127.0.0.1:{port}"))
    assert seen.state == "gone"
    assert seen.problems["network"]


@pytest.mark.parametrize(
    "body",
    [b"<html>", b"[]", b"{}", b'{"checks": 7}', b"", b"[" * 60_000, b'{"checks": {"a": 1e999}}'],
)
def test_what_is_no_health_is_no_robot(body):
    with socket.create_server(("127.0.0.1", 0)) as one:
        robot = FleetRobot(health=f"http://127.0.0.1:{one.getsockname()[1]}")
        answering = threading.Thread(target=_answer_once, args=(one, body))
        answering.start()
        seen = ask_robot(robot)
        answering.join()
    assert seen.state == "gone"


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
            assert asking.submit(ask_robot, robot).result(HUNG_S).state == "gone"
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
    watch = FleetWatch({"a": A, "b": B}, lambda _: LastSeen("ready"), clock)
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
            return LastSeen("gone")
        b_was_asked.set()
        return LastSeen("ready")

    watch = FleetWatch({"a": A, "b": B}, ask)
    watch.look()
    assert [one["state"] for one in watch.as_json()] == ["gone", "ready"]


def test_it_goes_on_asking_until_it_is_closed():
    asked = threading.Event()

    def ask(_):
        asked.set()
        return LastSeen("ready")

    watch = FleetWatch({"a": A}, ask)
    watch.start()
    try:
        assert asked.wait(HUNG_S)
    finally:
        watch.close()


def test_the_ill_ones_come_first():
    states = {"well": "ready", "low": "warned", "dead": "gone", "new": "unknown", "ill": "unwell"}
    robots = {name: FleetRobot(health=f"http://{name}:1") for name in states}
    watch = FleetWatch(robots, lambda robot: LastSeen(states[robot.health[7:-2]]))
    watch.look()
    assert [one["name"] for one in watch.as_json()] == ["dead", "ill", "low", "new", "well"]


@contextmanager
def page_of(watch: FleetWatch, folder: Path):
    """A running page without encryption, and the cookie of a browser that may look."""
    server = fleet_server(watch, folder, "127.0.0.1", 0, hosts=frozenset({"127.0.0.1"}))
    _, cookie = server.access.sessions.begin(Role.VIEWER, "phone", "127.0.0.1")
    with serving(server) as port:
        yield port, f"edgevox-fleet={cookie}"


def test_the_page_shows_what_the_watch_saw_and_takes_nothing(tmp_path):
    watch = FleetWatch({"a": A, "b": B}, lambda _: LastSeen("unwell", {"stt": "<b>"}))
    watch.look()
    with page_of(watch, tmp_path) as (port, cookie):
        status, page = get(port, "/")
        assert status == 200
        for path in re.findall(r'(?:src|href)="(/[^"]*)"', page.decode()):
            assert get(port, path)[0] == 200, path
        shown = json.loads(get(port, "/robots", Cookie=cookie)[1])["robots"]
        assert [one["problems"] for one in shown] == [{"stt": "<b>"}] * 2
        for method in ("POST", "PUT", "DELETE"):
            assert get(port, "/robots", method, Cookie=cookie)[0] == 405


def test_only_a_paired_browser_sees_the_robots(tmp_path):
    watch = FleetWatch({"a": A}, lambda _: LastSeen("ready"))
    with page_of(watch, tmp_path) as (port, cookie):
        assert get(port, "/robots")[0] == 401
        assert get(port, "/robots", Cookie=cookie[:-1])[0] == 401
        assert get(port, "/robots", Cookie=cookie)[0] == 200


@pytest.mark.parametrize("path", ["/", "/robots", "/api/me"])
def test_a_name_that_is_not_the_pages_is_not_answered(tmp_path, path):
    """Whoever makes a browser believe that evil.example is this machine sees nothing."""
    watch = FleetWatch({"a": A}, lambda _: LastSeen("ready"))
    with page_of(watch, tmp_path) as (port, cookie):
        assert get(port, path, Host=f"evil.example:{port}", Cookie=cookie)[0] == 421
        assert get(port, path, Host=f"127.0.0.1:{port}", Cookie=cookie)[0] == 200


def test_the_page_writes_text_and_never_html():
    script = (ROOT / "edgevox" / "apps" / "fleet" / "page" / "fleet.js").read_text()
    assert not re.search(r"innerHTML|outerHTML|insertAdjacent|document\.write|\beval\b", script)
    assert not re.search(r"<script>|\son\w+=|style=", script)


def test_the_command_serves_the_robots_of_a_file_with_encryption_to_whoever_has_the_code(tmp_path):
    file = tmp_path / "robots.yaml"
    file.write_text("robots: {a: {health: 'http://127.0.0.1:1'}}")
    program = f"import sys; from {main.__module__} import main; sys.exit(main())"
    asked = [sys.executable, "-c", program, "--robots", str(file), "--robots-port", "0"]
    asked += ["--console-folder", str(tmp_path / "console")]
    with subprocess.Popen(asked, stdout=subprocess.PIPE, text=True) as served:
        try:
            said = served.stdout.readline()
            port = int(re.fullmatch(r"1 robots on https://127.0.0.1:(\d+)\n", said)[1])
            code = next(line for line in served.stdout if "#pair=" in line).partition("=")[2]
            trusted = ssl.create_default_context(cafile=tmp_path / "console" / "ca.crt")
            robots = asyncio.run(robots_shown(f"https://localhost:{port}", code.strip(), trusted))
            assert [one["name"] for one in robots] == ["a"]
        finally:
            served.terminate()
        assert served.wait(HUNG_S) == 0


async def robots_shown(url: str, code: str, trusted: ssl.SSLContext) -> list[dict]:
    async with aiohttp.ClientSession() as browser:
        pair = {"json": {"code": code}, "headers": {"Origin": url}, "ssl": trusted}
        async with browser.post(f"{url}/api/pair", **pair) as let_in:
            assert (await let_in.json())["role"] == "viewer"
        async with browser.get(f"{url}/robots", ssl=trusted) as answer:
            return (await answer.json())["robots"]


def test_the_command_says_what_is_wrong_with_a_file(tmp_path, capsys):
    assert main(["--robots", str(tmp_path / "gone.yaml")]) == 2
    assert "robots" in capsys.readouterr().err
