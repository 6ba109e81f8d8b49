"""Health as it is asked for over HTTP, and what it is made of."""

import contextlib
import http.client
import json
import math
import resource
import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from support.clock import HeldClock
from waiting import wait_until

from edgevox import __version__
from edgevox.apps import health as command
from edgevox.core.agent_events import DrainStatus
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import ENV_PREFIX, Settings
from edgevox.core.status import (
    STALL_S,
    Components,
    Finding,
    HealthCheck,
    Level,
    Status,
    lives,
    moves,
)
from edgevox.ops.health import Health, HealthServer
from edgevox.ops.http_server import MOST_AT_ONCE, is_here
from edgevox.ops.machine import ClockComponent
from edgevox.robots.sim_loop import SimLoop
from edgevox.ros2.node import Heartbeat


@pytest.fixture
def health():
    return Health(Components())


@pytest.fixture
def server(health):
    one = HealthServer(health, "127.0.0.1", 0)
    one.start()
    yield one
    one.close()


def ask(server, path="/live", method="GET"):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    connection.request(method, path)
    answer = connection.getresponse()
    text = answer.read()
    connection.close()
    return answer.status, json.loads(text) if text else None


def test_it_is_alive_but_not_ready_until_all_is_started(health, server):
    health.add(HealthCheck("conversation", lambda: ""))
    assert ask(server) == (200, {"status": "ok", "checks": {"conversation": "ok"}})
    status, told = ask(server, "/ready")
    assert (status, told["checks"]["start"]) == (503, "starting")
    health.started()
    assert ask(server, "/ready") == (200, {"status": "ok", "checks": {"conversation": "ok"}})


def test_what_is_missing_makes_it_not_ready_and_what_is_dead_not_alive(health, server):
    health.started()
    fault = {"rclpy": "cannot be imported", "body": ""}
    health.add(HealthCheck("rclpy", lambda: fault["rclpy"], vital=False))
    health.add(HealthCheck("body", lambda: fault["body"]))
    assert (ask(server)[0], ask(server, "/ready")[0]) == (200, 503)
    fault.update(rclpy="", body="has not moved for 7.0 s")
    assert (ask(server)[0], ask(server, "/ready")[0]) == (503, 503)
    assert ask(server)[1]["checks"] == {"body": "has not moved for 7.0 s"}


class Drains:
    """As a drain, whose end a test brings about."""

    limit_s = 0.5

    def __init__(self):
        self.status, self.asked = None, []

    def begin(self, by):
        self.asked.append(by)
        self.status = self.status or DrainStatus.DRAINING


def test_who_drains_is_alive_and_not_ready(health, server):
    health.started()
    drain = Drains()
    health.offer(drain)
    assert ask(server, "/ready")[0] == 200
    drain.begin("SIGTERM")
    status, told = ask(server, "/ready")
    assert (status, told["checks"]["drain"]) == (503, "draining")
    assert ask(server)[0] == 200


def test_a_drain_is_begun_by_put_and_told_until_it_is_over(health, server):
    assert ask(server, "/drain", "PUT")[0] == 503
    drain = Drains()
    health.offer(drain)
    assert ask(server, "/drain")[0] == 404
    assert ask(server, "/drain", "POST")[0] == 405
    assert drain.asked == [], "nothing but PUT begins it"
    assert ask(server, "/drain", "PUT") == (202, {"status": "draining", "within_s": 0.5})
    assert drain.asked == ["edgevox-health"]
    for status, code in ((DrainStatus.DRAINED, 200), (DrainStatus.NOT_STANDING, 500)):
        drain.status = status
        assert ask(server, "/drain") == (code, {"status": str(status), "within_s": 0.5})


@pytest.mark.parametrize(
    ("peer", "here"),
    [
        ("127.0.0.1", True),
        ("::1", True),
        ("::ffff:127.0.0.1", True),
        ("fe80::1%eth0", False),
        ("10.1.2.3", False),
        ("::ffff:10.1.2.3", False),
        ("", False),
    ],
)
def test_only_this_machine_may_begin_one(peer, here):
    assert is_here(peer) is here


@pytest.mark.parametrize(
    ("ends", "code"), [(DrainStatus.DRAINED, 0), (DrainStatus.NOT_STANDING, 1), (None, 1)]
)
def test_the_command_waits_for_a_drain_and_tells_how_it_ended(
    health, server, monkeypatch, capsys, ends, code
):
    drain, now_s = Drains(), [0.0]
    health.offer(drain)

    def sleep(seconds):
        now_s[0] += seconds
        drain.status = ends or drain.status

    monkeypatch.setattr(command, "time", SimpleNamespace(sleep=sleep, monotonic=lambda: now_s[0]))
    assert command.main(["--drain", "--port", str(server.port)]) == code
    assert capsys.readouterr().out.strip() == str(ends or DrainStatus.DRAINING)


def test_a_check_that_breaks_is_a_finding(health, server):
    health.add(HealthCheck("body", lambda: 1 / 0))
    status, told = ask(server)
    assert status == 503
    assert "ZeroDivisionError" in told["checks"]["body"]


def test_other_paths_and_methods_are_refused(server):
    assert ask(server, "/metrics")[0] == 404
    assert ask(server, "/live", "POST")[0] == 405
    assert ask(server, "/live", "HEAD") == (200, None)
    assert ask(server, "/live?verbose=1")[0] == 200


def test_who_says_nothing_or_too_much_does_not_keep_others_from_an_answer(server):
    silent = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(MOST_AT_ONCE - 2)]
    flood = socket.create_connection(("127.0.0.1", server.port))
    flood.sendall(b"GET /live HTTP/1.1\r\n" + b"X: " + b"x" * 100_000)
    flood.settimeout(10)
    with contextlib.suppress(ConnectionResetError):
        assert flood.recv(1) == b""
    assert ask(server)[0] == 200
    for one in silent:
        one.settimeout(10)
        assert one.recv(1) == b""  # hung up on after its two seconds
        one.close()
    flood.close()


def test_a_port_that_is_taken_is_said(health, server):
    with pytest.raises(InvalidValue, match=rf"health_port: got '127.0.0.1:{server.port}'.*in use"):
        HealthServer(health, "127.0.0.1", server.port)
    with pytest.raises(InvalidValue, match="health_port: got 'no such host:1'"):
        HealthServer(health, "no such host", 1)


def test_close_leaves_no_thread_and_frees_the_port(health):
    one = HealthServer(health, "127.0.0.1", 0)
    one.start()
    stuck = socket.create_connection(("127.0.0.1", one.port))
    port = one.port
    one.close()
    assert "edgevox-health" not in [thread.name for thread in threading.enumerate()]
    stuck.close()
    HealthServer(health, "127.0.0.1", port).close()


def test_what_stalls_is_unwell_after_a_while_and_what_rests_never():
    stalled_s = 0.0
    look = moves(lambda: stalled_s)
    assert look() == ""
    stalled_s = STALL_S + 0.1
    assert look() == "has not moved for 6.1 s"
    stalled_s = math.inf
    assert look() == "has not moved for inf s"
    assert (lives(lambda: True)(), lives(lambda: False)()) == ("", "its thread has ended")


def test_a_heart_is_as_silent_as_its_last_beat_is_old():
    clock = HeldClock()
    heart = Heartbeat(clock)
    clock.now_s = 3.0
    assert heart.silent_s == 3.0
    heart.beat()
    assert heart.silent_s == 0.0


def test_a_step_that_blocks_is_a_stall_and_ends_with_it():
    clock, entered, released = HeldClock(), threading.Event(), threading.Event()

    def step():
        entered.set()
        released.wait(60)
        return False

    sim_loop = SimLoop(step, period_s=0.02, speed=None, clock=clock)
    assert sim_loop.stalled_s == 0.0
    sim_loop.start()
    assert entered.wait(60)
    clock.now_s = 7.0
    assert sim_loop.stalled_s == 7.0
    released.set()
    sim_loop.advance(0.02)
    clock.now_s = 100.0
    wait_until(lambda: sim_loop.stalled_s == 0.0)  # nothing to do, so it rests
    sim_loop.close()
    assert sim_loop.stalled_s == 0.0


def test_steps_that_all_fail_are_a_stall():
    clock, failed = HeldClock(), threading.Semaphore(0)

    def step():
        clock.now_s += 1.0
        failed.release()
        raise ValueError("diverged")

    sim_loop = SimLoop(step, period_s=0.02, speed=None, clock=clock, sleep=lambda _: None)
    sim_loop.start()
    for _ in range(4):
        assert failed.acquire(timeout=60)
    assert sim_loop.stalled_s >= 3.0
    sim_loop.close()


def test_the_command_tells_and_its_exit_code_does(health, server, monkeypatch, capsys):
    monkeypatch.setenv(command.PORT, str(server.port))
    assert command.main(["--live"]) == command.WELL
    assert command.main([]) == command.UNWELL
    assert "failing: start starting" in capsys.readouterr().out
    health.started()
    assert command.main(["--ready"]) == command.WELL


@contextmanager
def full_disk():
    """Nothing of this process can write a byte to a file."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_an_agent_that_was_alive_and_is_frozen_is_killed_after_a_while(monkeypatch, tmp_path):
    killed = []
    monkeypatch.setattr(command, "FROZEN_NOTE", tmp_path / "note")
    monkeypatch.setattr(command, "agents_of_init", lambda: [7])
    monkeypatch.setattr(command.os, "kill", lambda *told: killed.append(told))
    late_s = command.FROZEN_S
    looks = [
        *((False, 0.0), (False, 2 * late_s)),  # one that starts
        *((True, 100.0), (False, 101.0), (False, 101.0 + late_s - 0.1), (True, 101.0 + late_s)),
        *((False, 200.0), (False, 200.0 + late_s - 0.1)),
    ]
    with full_disk():
        full = isinstance(attempt(lambda: (tmp_path / "other").write_text("x")), OSError)
        for lives, now_s in looks:
            command.note_frozen(lives, now_s)
        before = list(killed)
        command.note_frozen(False, 200.0 + late_s)
        command.note_frozen(False, 300.0 + late_s)
    assert full
    assert before == []
    assert killed == [(7, 9)], "the next one is new, and has not answered yet"


def attempt(act):
    """The error of an act; None where there is none."""
    try:
        act()
    except OSError as error:
        return error
    return None


def test_a_health_check_notes_whether_the_agent_lives(health, server, monkeypatch, tmp_path):
    note, said = tmp_path / "note", {"dead": "stuck"}
    health.add(HealthCheck("body", lambda: said["dead"]))
    monkeypatch.setenv("EDGEVOX_HEALTH_PORT", str(server.port))
    monkeypatch.setattr(command, "FROZEN_NOTE", note)
    assert command.main(["--ready", "--end-frozen"]) == 1
    assert not note.exists()
    said["dead"] = ""
    assert command.main(["--ready", "--end-frozen"]) == 1, "alive, and not ready yet"
    assert note.stat().st_mtime == 0
    said["dead"] = "stuck"
    command.main(["--ready", "--end-frozen"])
    assert note.stat().st_mtime > 0


def test_a_health_check_says_how_it_is_where_it_can_note_nothing(
    health, server, monkeypatch, tmp_path
):
    monkeypatch.setenv("EDGEVOX_HEALTH_PORT", str(server.port))
    monkeypatch.setattr(command, "FROZEN_NOTE", tmp_path / "gone" / "note")
    health.started()
    assert command.main(["--ready", "--end-frozen"]) == command.WELL


def test_only_a_containers_own_agent_is_killed(tmp_path):
    processes = {1: ("tini", 0), 7: ("edgevox-agent", 1), 8: ("bash", 1), 9: ("edgevox-agent", 8)}
    for number, (name, parent) in processes.items():
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "status").write_text(f"Name:\t{name}\nX:\t0\nPPid:\t{parent}\n")
    assert list(command.agents_of_init(tmp_path)) == [7]


def test_the_command_says_why_it_cannot_ask(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    assert command.main(["--port", str(port)]) == command.UNWELL
    assert "refused" in capsys.readouterr().err
    assert command.main(["--port", "0"]) == command.USAGE_ERROR
    assert command.PORT in capsys.readouterr().err


def test_a_node_that_listens_on_all_addresses_is_asked_on_loopback():
    assert command.reachable("0.0.0.0") == "127.0.0.1"  # noqa: S104
    assert command.reachable("::") == "::1"
    assert command.reachable("localhost") == "localhost"


def test_the_commands_variables_are_the_settings():
    names = {f"{ENV_PREFIX}{name.upper()}" for name in Settings.model_fields}
    assert {command.PORT, command.HOST} <= names
    assert Settings.model_fields["health_host"].default == command.LOOPBACK[4]


class Part:
    """A component that is as it is told to be."""

    checks = ()

    def __init__(self, name: str, look) -> None:
        self.name, self.status = name, look


def told_by(*parts) -> HealthServer:
    return HealthServer(Health(Components(*parts)), "127.0.0.1", 0)


@contextmanager
def answering(one: HealthServer):
    one.start()
    try:
        yield one
    finally:
        one.close()


def test_its_status_tells_what_it_is_and_how_each_component_is(monkeypatch):
    monkeypatch.setenv("EDGEVOX_IMAGE", "edgevox-ros2:7")
    warned = [Finding(Level.WARN, "battery at 9 %")]
    sim = Part("sim", lambda: Status.judged("sim", warned, battery=0.09))
    console = Part("console", lambda: Status.judged("console", commander="Anna's phone"))
    with answering(told_by(sim, console)) as one:
        status, told = ask(one, "/status")
    assert (status, told["version"], told["image"]) == (200, __version__, "edgevox-ros2:7")
    first, second = told["components"]
    assert first["message"] == "battery at 9 %"
    assert (first["level"], first["values"]) == (Level.WARN, {"battery": 0.09})
    assert (second["name"], second["values"]) == ("console", {}), "it would tell who is there"


def test_a_component_that_hangs_keeps_nobody_from_knowing_whether_it_lives():
    hangs = threading.Event()
    asked = threading.Event()

    def look() -> Status:
        asked.set()
        hangs.wait()
        return Status.judged("sim")

    with answering(told_by(Part("sim", look))) as one, ThreadPoolExecutor(1) as pool:
        status = pool.submit(ask, one, "/status")
        assert asked.wait(60)
        assert ask(one, "/live")[0] == 200
        hangs.set()
        assert status.result()[0] == 200


@pytest.mark.parametrize(
    ("synchronised", "now_s", "level"),
    [
        (True, 2e9, Level.OK),
        (None, 2e9, Level.OK),
        (False, 2e9, Level.WARN),
        (True, 1e9, Level.ERROR),
    ],
)
def test_a_clock_that_is_not_synchronised_is_told_and_makes_nothing_unready(
    synchronised, now_s, level
):
    clock = ClockComponent(lambda: synchronised, lambda: now_s)
    assert clock.status().level is level
    health = Health(Components(clock))
    health.started()
    assert health.ready().well
