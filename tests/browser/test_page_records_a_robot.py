"""A recording of a real robot on ROS 2, begun, ended and taken home on the page of a browser."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from browser_rig import DESK, PATIENCE_MS, let_in, take_the_turn
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from playwright.sync_api import Browser, Page, expect
from ports import free_port
from rosbags.highlevel import AnyReader
from waiting import wait_until

pytestmark = pytest.mark.long

RESPONSE = "/edgevox/response"
FRESH_S = 15.0
"""An answer that is not in the file by then was given before the recorder heard the robot."""


@pytest.fixture
def link(tmp_path: Path, domain: int) -> Iterator[str]:
    """That of an agent with its robot, to be let in by."""
    with subprocess.Popen(
        [
            *(str(Path(sys.executable).with_name("edgevox-agent")), "robot-apartment"),
            *("--text-mode", "--ros2", "--llm=none", "--console", "--console-tls=off"),
            *(f"--console-port={free_port()}", f"--console-folder={tmp_path / 'console'}"),
            f"--console-recordings={tmp_path / 'recordings'}",
        ],
        env={
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        },
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout
        yield next(line.strip() for line in process.stdout if "/#pair=" in line)
        process.terminate()
        process.communicate()


def test_what_the_robot_answers_is_in_the_file_that_was_taken_home(
    browser: Browser, link: str, tmp_path: Path
) -> None:
    context = browser.new_context(locale="en-GB", **DESK)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    let_in(page, link)
    take_the_turn(page)
    page.locator(".side-switch:visible .tab[data-panel=know]").click()
    page.get_by_role("button", name="Start recording").click()
    page.get_by_role("button", name="Stop recording").wait_for()
    while not _is_recorded(page, tmp_path / "recordings"):
        pass
    page.get_by_role("button", name="Stop recording").click()
    with page.expect_download() as begun:
        page.locator(".files a").click()
    assert re.fullmatch(r"edgevox-\d{8}-\d{6}_0\.mcap", begun.value.suggested_filename)
    taken = tmp_path / begun.value.suggested_filename
    begun.value.save_as(taken)
    context.close()
    with AnyReader([taken]) as bag:
        said = [
            bag.deserialize(raw, connection.msgtype).data
            for connection, _, raw in bag.messages()
            if connection.topic == RESPONSE
        ]
    assert said
    assert all("living room" in one for one in said)


def _is_recorded(page: Page, folder: Path) -> bool:
    """Ask where the robot is; whether its answer came to the file, too."""
    answers = page.locator(".bubble.robots")
    before = answers.count()
    page.locator(".write input").fill("where are you")
    page.locator(".write input").press("Enter")
    expect(answers).to_have_count(before + 1)
    with suppress(AssertionError):
        wait_until(lambda: RESPONSE in _topics(folder), timeout_s=FRESH_S)
    return RESPONSE in _topics(folder)


def _topics(folder: Path) -> set[str]:
    """Those of which a message is in the file, which may have no end yet."""
    channels: dict[int, str] = {}
    heard: set[str] = set()
    for file in folder.glob("*/*.mcap.open"):
        with suppress(EndOfFile), file.open("rb") as stream:
            for record in StreamReader(stream).records:
                if isinstance(record, Channel):
                    channels[record.id] = record.topic
                elif isinstance(record, Message):
                    heard.add(channels[record.channel_id])
    return heard
