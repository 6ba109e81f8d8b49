"""A console that was asked for and answers nobody is found, by whoever asks after the robot."""

import asyncio
import socket
from pathlib import Path

import pytest
from support.clock import HeldClock
from waiting import wait_until

from edgevox.apps import health as edgevox_health
from edgevox.console.door import Door, cut
from edgevox.console.page_server import Liveness
from edgevox.core.status import STALL_S, Components, Level
from edgevox.ops.health import Health, HealthServer
from tests.console_rig import Rig, console


def ask(rig: Rig) -> int:
    """The exit code of `edgevox-health`, as a container's health check asks."""
    health = Health(Components(rig.server))
    health.started()
    served = HealthServer(health, "127.0.0.1", 0)
    served.start()
    try:
        return edgevox_health.main(["--ready", "--port", str(served.port)])
    finally:
        served.close()


def test_one_that_answers_is_well(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with console(tmp_path) as rig:
        assert ask(rig) == 0
        assert "console ok" in capsys.readouterr().out
        assert rig.server.status().level is Level.OK


def test_one_whose_listener_has_ended_is_not_ready(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    async def ends(_: Door) -> None:
        raise RuntimeError("as nobody thought")

    monkeypatch.setattr(Door, "serve", ends)
    with console(tmp_path) as rig:
        wait_until(lambda: rig.server.status().level is not Level.OK, "the end of the listener")
        assert ask(rig) == 1
        assert "console nobody is let in any more" in capsys.readouterr().out
        (check,) = rig.server.checks
        assert not check.vital
        assert rig.server.status().level is Level.ERROR


def test_one_whose_thread_has_ended_is_not_ready(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with console(tmp_path) as rig:
        rig.server.close()
        assert ask(rig) == 1
        assert "thread" in capsys.readouterr().out


def test_a_listening_socket_that_takes_nobody_is_told() -> None:
    async def knock() -> tuple[str, str]:
        with socket.create_server(("127.0.0.1", 0)) as listening:
            listening.setblocking(False)
            door = Door(listening, asyncio.Protocol, tls=None)
            living = Liveness(HeldClock(), lambda: True)
            listening.close()
            serving = asyncio.create_task(door.serve())
            living.watch(door, serving)
            async with asyncio.timeout(30):
                while not living.why_not():
                    await asyncio.sleep(0.01)
            shut = living.why_not()
            serving.cancel()
            await asyncio.wait([serving])
            return shut, living.why_not()

    shut, ended = asyncio.run(knock())
    assert shut.startswith("nobody is let in: ")
    assert ended == "nobody is let in any more"


def test_a_transport_that_cannot_be_aborted_any_more_ends_no_server() -> None:
    class ClosedTwice(asyncio.Transport):
        """As a TLS transport of Python 3.11.2 is, once it was closed twice."""

        def abort(self) -> None:
            raise AttributeError("'NoneType' object has no attribute '_abort'")

    cut(ClosedTwice())
    cut(None)


def test_a_loop_that_stands_still_is_told_after_a_while() -> None:
    clock = HeldClock()
    living = Liveness(clock, lambda: True)

    async def once() -> None:
        beating = asyncio.create_task(living.beat())
        await asyncio.sleep(0)
        beating.cancel()

    asyncio.run(once())
    clock.now_s += STALL_S
    assert not living.why_not()
    clock.now_s += 0.1
    assert living.why_not() == "its loop stands still"
