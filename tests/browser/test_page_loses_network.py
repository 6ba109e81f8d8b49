"""The network is away for 5 s while somebody talks: what was said then is gone, and all goes on."""

from collections.abc import Iterator

import pytest
from browser_rig import take_the_turn
from console_rig import Rig, console
from frozen_line import FrozenLine
from playwright.sync_api import Page, Playwright, expect
from sound_rig import PATIENCE_MS, microphone, paired, tone, write
from test_page_drives import until
from test_page_sound import NotedSound, hold

pytestmark = pytest.mark.long

AWAY_MS = 5000


@pytest.fixture
def sound() -> NotedSound:
    return NotedSound()


@pytest.fixture
def rig(tmp_path, sound: NotedSound) -> Iterator[Rig]:
    shown = {"capabilities": {"sound": True}, "languages": ["en"]}
    with console(tmp_path, sound=sound, describe=lambda _: shown) as rig:
        yield rig


@pytest.fixture
def line(rig: Rig) -> Iterator[FrozenLine]:
    with FrozenLine(rig.server.port) as line:
        yield line


@pytest.fixture
def page(playwright: Playwright, rig: Rig, line: FrozenLine, tmp_path) -> Iterator[Page]:
    file = write(tmp_path / "tone.wav", tone(1000.0, 2.0))
    link = rig.server.offer_code()[1].replace(str(rig.server.port), str(line.port))
    with microphone(playwright, file) as browser, paired(browser, link) as page:
        yield page


def test_what_is_said_while_it_is_away_is_never_heard_and_all_works_again(
    page: Page, rig: Rig, line: FrozenLine, sound: NotedSound
) -> None:
    hold(page)
    sound.wait(lambda: len(sound.frames) >= 50)
    line.freeze()
    page.locator("html[data-link=gone]").wait_for()
    page.mouse.up()
    page.locator(".write input").fill("go to the kitchen")
    page.locator(".write input").press("Enter")
    expect(page.locator(".notes")).to_contain_text("Not sent")
    page.wait_for_timeout(AWAY_MS)
    heard = len(sound.frames)
    line.thaw()

    page.locator("html[data-link=ready]").wait_for()
    sound.wait(lambda: {"closed", "abandoned"} & set(sound.asked))
    assert sound.asked == ["held", "abandoned"]  # it was cut off: it must not be acted on
    assert len(sound.frames) == heard
    assert not rig.submitted

    page.locator(".lease button.primary:visible, .lease button.on:visible").first.wait_for()
    if page.locator(".lease button.primary:visible").count():
        take_the_turn(page)
    hold(page)
    sound.wait(lambda: len(sound.frames) >= heard + 20)
    page.mouse.up()
    sound.wait(lambda: sound.asked[-1] == "closed")
    page.locator(".write input").fill("stop there")
    page.locator(".write input").press("Enter")
    until(page, lambda: bool(rig.submitted))
    assert [one.text for one in rig.submitted] == ["stop there"]


def test_what_the_robot_says_meanwhile_is_not_played_late(
    page: Page, line: FrozenLine, sound: NotedSound
) -> None:
    page.evaluate(
        """async () => {
          const { Sound } = await import('/static/sound/sound.js');
          window.sound = new Sound(() => {});
          await window.sound.connect();
          await window.sound.hear(true);
          window.turns = [];
          const post = window.sound.player.port.postMessage.bind(window.sound.player.port);
          window.sound.player.port.postMessage = (data, ...rest) => {
            if (data) window.turns.push(data.turn);
            post(data, ...rest);
          };
        }"""
    )
    sound.wait(lambda: sound.hears)
    piece = bytes(640)

    def say(turn: int) -> None:
        for callback, _ in tuple(sound.hears):
            callback(turn, piece)

    def say_until_played(turn: int) -> None:
        while not page.evaluate("turn => window.turns.includes(turn)", turn):
            say(turn)
            page.wait_for_timeout(20)

    say_until_played(1)
    line.freeze()
    for _ in range(10):
        say(2)
        page.wait_for_timeout(20)
    page.wait_for_timeout(AWAY_MS)
    line.thaw()
    page.locator("html[data-link=ready]").wait_for(timeout=PATIENCE_MS)
    say_until_played(3)
    assert 2 not in page.evaluate("window.turns")
