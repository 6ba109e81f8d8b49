"""A recording of a robot that runs, begun, ended and taken home by its console."""

import asyncio

import aiohttp
import pytest
from agent_process import READY, Agent
from peer import Peer
from ports import free_port
from recordings import texts_of, until_recorded
from waiting import wait_until


@pytest.fixture
def agent(domain, tmp_path):
    folder = f"--console-folder={tmp_path / 'console'}"
    options = ("--console-host=127.0.0.1", f"--console-port={free_port()}", "--console-tls=off")
    one = Agent(
        *("robot-apartment", "--text-mode", "--ros2", "--llm=none", "--console", folder, *options),
        domain=domain,
    )
    yield one
    one.terminate()


@pytest.fixture
def peer(domain):
    one = Peer(domain)
    yield one
    one.close()


@pytest.mark.long
def test_what_is_typed_while_it_records_is_in_the_file_also_of_an_agent_that_was_killed(
    agent, peer, tmp_path
):
    agent.wait_for_line(READY)
    url, _, code = agent.wait_for_line("/#pair=").strip().partition("/#pair=")

    def files():
        return set((tmp_path / "console").rglob("*.mcap*"))

    async def begin(socket):
        before = files()
        await socket.send_json({"id": 3, "type": "record", "action": "start"})
        await status(socket, lambda one: one["running"])
        await asyncio.to_thread(until_recorded, peer, lambda: files() - before, ["response"])

    async def record():
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(cookie_jar=jar, headers={"Origin": url}) as client:
            async with client.post(f"{url}/api/pair", json={"code": code}) as told:
                assert told.status == 200
            async with client.ws_connect(f"{url}/ws", max_msg_size=0) as socket:
                await socket.send_json({"id": 1, "type": "lease", "action": "take"})
                await socket.send_json({"id": 2, "type": "look", "what": ["status"]})
                await begin(socket)
                await socket.send_json({"id": 4, "type": "record", "action": "stop"})
                state = await status(socket, lambda one: one["files"] and not one["running"])
                (file,) = state["files"]
                async with client.get(f"{url}/api/recording/{file['name']}") as told:
                    assert told.status == 200
                    (tmp_path / "taken.mcap").write_bytes(await told.read())
                assert (tmp_path / "taken.mcap").stat().st_size == file["bytes"]
                taken = files()
                await begin(socket)
            return taken

    taken = asyncio.run(record())
    heard = texts_of(tmp_path / "taken.mcap")
    assert {text for _, text in heard["/edgevox/text_input"]} == {"where are you"}
    assert heard["/edgevox/response"]

    agent.process.kill()
    (open_file,) = files() - taken
    file = open_file.with_suffix("")
    wait_until(file.exists, "the end of the file")
    assert {text for _, text in texts_of(file)["/edgevox/text_input"]} == {"where are you"}


async def status(socket, wanted):
    """The first state of the recording that is as wanted."""
    async for told in socket:
        message = told.json()
        assert message["type"] != "error", message
        if message["type"] == "status" and wanted(message["recording"]):
            return message["recording"]
    raise AssertionError("the socket was closed")
