"""An agent that is asked for a console serves one, and a browser's stop stands its robot still."""

import asyncio
import socket
from contextlib import ExitStack

import aiohttp
import pytest
from ports import free_port
from small_disk import small_disk
from waiting import wait_until

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.console import phone
from edgevox.apps.console.phone import NotOpen, pair_phone
from edgevox.console.certificates import local_names, own_tls
from edgevox.console.sessions import Opened, Pairing, Role, Sessions
from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import load_settings
from edgevox.core.status import Level
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot


@pytest.fixture
def start(tmp_path):
    with ExitStack() as stack:

        def begin(**settings):
            wanted = {"text_mode": True, "llm": "none", "console": True, "console_tls": "off"}
            wanted |= {"console_folder": str(tmp_path / "console"), **settings}
            parts = build_parts(stack, load_settings(wanted), ApartmentRobot(speed=0.0))
            start_parts(stack, parts)
            return parts

        yield begin


def test_it_prints_the_address_and_a_code_and_is_listed_as_a_component(start, capsys):
    port = free_port()
    parts = start(console_port=port)
    printed = capsys.readouterr().out
    assert f"Console: http://127.0.0.1:{port}" in printed
    assert "#pair=" in printed
    (console,) = parts.components.statuses({"console"})
    assert console.values["url"] == f"http://127.0.0.1:{port}"


@pytest.mark.parametrize(("tls", "said"), [("off", "No pairing code"), ("own", "No console")])
def test_a_folder_that_cannot_be_written_costs_the_robot_its_console_at_most(
    start, tmp_path, capsys, tls, said
):
    file = tmp_path / "file"
    file.write_text("")

    parts = start(console_port=free_port(), console_folder=str(file), console_tls=tls)

    assert f"{said}: console_folder: {file}" in capsys.readouterr().out
    assert parts.conversation.alive
    (console,) = parts.components.statuses({"console"})
    assert console.level > Level.OK


def test_on_a_full_disk_the_robot_starts_and_who_is_paired_stops_it(start, tmp_path, capsys):
    with small_disk(tmp_path / "disk") as disk:
        folder = disk.path / "console"
        _, cookie = Sessions(folder).begin(Role.OPERATOR, "phone", "127.0.0.1")
        own_tls(folder, local_names())
        disk.fill()

        parts = start(console_port=free_port(), console_folder=str(folder), console_tls="own")

        assert "No pairing code: console_folder" in capsys.readouterr().out
        (console,) = parts.components.statuses({"console"})
        assert "No space left" in console.message
        assert Sessions(folder).of_cookie(cookie)
        assert parts.conversation.alive


def test_a_taken_port_ends_the_agent_of_who_asked_for_the_console(start):
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(EdgeVoxError, match="port"):
        start(console_port=taken.getsockname()[1])


def test_where_it_may_be_missing_a_taken_port_is_one_line_and_the_agent_goes_on(start, capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        parts = start(console_port=port, console_optional=True)
    (said,) = [line for line in capsys.readouterr().out.splitlines() if "onsole" in line]
    assert said.startswith(f"No console: console_port: got '127.0.0.1:{port}'")
    assert parts.notes == [said]
    assert parts.conversation.alive
    assert parts.health.ready().well
    (console,) = parts.components.statuses({"console"})
    assert console.message.startswith("off: console_port")


def test_what_a_full_screen_hides_is_kept_for_it(start, capsys):
    port = free_port()
    address, invited = start(console_port=port).notes
    assert address == f"Console: http://127.0.0.1:{port}"
    assert invited.split()[0] in capsys.readouterr().out


async def _press_stop(url, code):
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as browser:
        headers = {"Origin": url}
        async with browser.post(f"{url}/api/pair", json={"code": code}, headers=headers) as told:
            assert told.status == 200, await told.text()
        async with browser.ws_connect(f"{url}/ws", headers=headers) as line:
            hello = await line.receive_json()
            await line.send_json({"type": "stop", "id": 1})
            stop = await line.receive_json()
            while stop["type"] != "stop":
                stop = await line.receive_json()
            return hello, stop


def test_a_browser_is_greeted_and_its_stop_stands_the_robot_still(start, capsys):
    parts = start(console_port=free_port())
    printed = capsys.readouterr().out
    url, _, code = next(line for line in printed.split() if "#pair=" in line).partition("/#pair=")
    parts.body.set_velocity(Twist2D(0.3, 0.0))
    parts.body.advance(0.2)
    hello, stop = asyncio.run(_press_stop(url, code))
    assert hello["type"] == "hello"
    assert {one["name"] for one in hello["skills"]} == {one.name for one in parts.skills}
    assert stop["engaged"]
    wait_until(lambda: parts.software_stop.state.engaged, "it is stopped")
    parts.body.advance(0.1)
    assert parts.body.velocity().linear_m_s == pytest.approx(0.0, abs=1e-6)


PHONES = "127.0.0.2"
"""An address at which a console that serves 127.0.0.1 does not answer."""


def _let_phone_in(folder, port, *, agrees=True, **settings):
    asked = []

    def agree(url):
        asked.append(url)
        return agrees

    wanted = load_settings({"console_port": port, "console_names": PHONES, **settings})
    return pair_phone(wanted, folder, Role.OPERATOR, agree), asked


def _answers(port):
    with socket.socket() as one:
        return one.connect_ex((PHONES, port)) == 0


def test_a_phone_is_let_in_at_an_address_that_is_opened_once_a_person_agrees(start, tmp_path):
    port, folder = free_port(), tmp_path / "console"
    start(console_port=port, console_tls="own")
    with pytest.raises(NotOpen):
        _let_phone_in(folder, port, agrees=False)
    assert not _answers(port)

    offered, asked = _let_phone_in(folder, port)

    assert asked == [offered.url] == [f"https://{PHONES}:{port}"]
    assert _answers(port)
    assert Pairing(folder).redeem(offered.code.code) is Role.OPERATOR
    assert _let_phone_in(folder, port)[1] == []
    assert Opened(folder).close()
    wait_until(lambda: not _answers(port), "it is closed again")


def test_an_address_that_settings_chose_is_not_added_to(start, tmp_path, monkeypatch):
    monkeypatch.setattr(phone, "OPENS_S", 0.0)
    port, folder = free_port(), tmp_path / "console"
    start(console_port=port, console_tls="own", console_host="127.0.0.1")
    with pytest.raises(EdgeVoxError, match=f"--console-host 0.0.0.0 --console-names {PHONES}"):
        _let_phone_in(folder, port)
    assert Opened(folder).address() == ""


def test_a_phone_needs_a_robot_that_runs_and_an_address(tmp_path):
    with pytest.raises(EdgeVoxError, match="nothing answers"):
        _let_phone_in(tmp_path, free_port())
    with pytest.raises(EdgeVoxError, match="CONSOLE_ADDRESS"):
        _let_phone_in(tmp_path, free_port(), console_names="localhost")


def test_an_opened_address_that_no_private_network_has_is_not_listened_on(tmp_path):
    Opened(tmp_path).open("8.8.8.8")
    assert Opened(tmp_path).address() == ""
