"""Sound between a real browser and the server: what is said into the page, and what it plays."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from browser_rig import PHONE, let_in, page_words
from console_rig import Rig, console
from playwright.sync_api import Browser, Page, Playwright, expect
from sound_rig import PATIENCE_MS, microphone, paired, tone, write
from test_page_drives import until

HERTZ = 1000.0
WAIT_S = 60.0


class NotedSound:
    """Ears that keep what they hear, and a mouth that says what a test wants."""

    def __init__(self) -> None:
        self.frames: list[np.ndarray] = []
        self.asked: list[str] = []
        self.hears: list[tuple[Callable[[int, bytes], None], Callable[[], None]]] = []
        self.changed = threading.Condition()

    def open(self, client: str, *, held: bool) -> bool:
        return self._note("held" if held else "open")

    def close(self, client: str) -> None:
        self._note("closed")

    def abandon(self, client: str) -> None:
        self._note("abandoned")

    def push(self, client: str, samples: np.ndarray) -> None:
        with self.changed:
            self.frames.append(samples)
            self.changed.notify_all()

    def listen(
        self, callback: Callable[[int, bytes], None], on_flush: Callable[[], None]
    ) -> Callable[[], None]:
        one = (callback, on_flush)
        with self.changed:
            self.hears.append(one)
            self.changed.notify_all()
        return lambda: self.hears.remove(one)

    def wait(self, true: Callable[[], object]) -> None:
        with self.changed:
            assert self.changed.wait_for(true, WAIT_S), (self.asked, len(self.frames))

    def _note(self, asked: str) -> bool:
        with self.changed:
            self.asked.append(asked)
            self.changed.notify_all()
        return True


@pytest.fixture
def sound() -> NotedSound:
    return NotedSound()


@pytest.fixture
def rig(tmp_path: Path, sound: NotedSound) -> Iterator[Rig]:
    capabilities = {"capabilities": {"sound": True}, "languages": ["en"]}
    with console(tmp_path, sound=sound, describe=lambda _: capabilities) as rig:
        yield rig


@pytest.fixture(scope="module")
def listening(playwright: Playwright, tmp_path_factory) -> Iterator[Browser]:
    file = write(tmp_path_factory.mktemp("sound") / "tone.wav", tone(HERTZ, 2.0))
    with microphone(playwright, file) as browser:
        yield browser


@pytest.fixture
def page(listening: Browser, rig: Rig) -> Iterator[Page]:
    with paired(listening, rig.server.offer_code()[1]) as page:
        yield page


def hold(page: Page) -> None:
    page.locator(".sound .hold").hover()
    page.mouse.down()


def test_the_robot_hears_what_the_microphone_does_while_the_button_is_held(
    page: Page, sound: NotedSound
) -> None:
    hold(page)
    sound.wait(lambda: len(sound.frames) >= 100)
    page.mouse.up()
    sound.wait(lambda: "closed" in sound.asked)
    assert sound.asked == ["held", "closed"]
    heard = np.concatenate(sound.frames[50:100]).astype(float)
    spectrum = np.abs(np.fft.rfft(heard * np.hanning(heard.size)))
    loudest = np.argmax(spectrum) * 16_000 / heard.size
    assert loudest == pytest.approx(HERTZ, abs=5.0)


LEVEL = "e => Number(getComputedStyle(e).getPropertyValue('--level'))"


def test_the_button_that_is_pressed_shows_how_loud_the_microphone_is(
    page: Page, sound: NotedSound
) -> None:
    button = page.locator(".sound .hold")
    expect(button.locator(".level")).to_be_hidden()
    hold(page)
    until(page, lambda: 0.5 < button.evaluate(LEVEL) < 1)
    expect(button.locator(".level")).to_be_visible()
    page.mouse.up()
    until(page, lambda: button.evaluate(LEVEL) == 0)
    opened = page.get_by_role("button", name=page_words("open_microphone"))
    opened.click()
    until(page, lambda: 0.5 < opened.evaluate(LEVEL) < 1)
    opened.click()
    until(page, lambda: opened.evaluate(LEVEL) == 0)


def test_the_first_hold_asks_for_the_microphone_and_says_when_to_hold_again(
    page: Page, sound: NotedSound
) -> None:
    page.evaluate(
        """() => {
          const media = navigator.mediaDevices, given = media.getUserMedia.bind(media);
          let state = "prompt";
          navigator.permissions.query = async () => ({ state });
          media.getUserMedia = (what) => new Promise((done) => {
            window.allow = () => { state = "granted"; done(given(what)); };
          }); }"""
    )
    button = page.locator(".sound .hold")
    hear = page.get_by_role("button", name=page_words("hear_here"))
    hold(page)
    expect(button).to_have_text(page_words("allow_microphone"))
    until(page, lambda: page.evaluate("Boolean(window.allow)"))
    page.mouse.up()
    page.evaluate("window.allow()")
    expect(page.locator(".toast.good")).to_have_text(page_words("microphone_ready"))
    expect(button).to_have_text(page_words("hold_to_talk"))
    assert "held" not in sound.asked
    expect(hear).to_have_attribute("aria-pressed", "true")
    sound.wait(lambda: sound.hears)
    hold(page)
    sound.wait(lambda: sound.frames)
    assert sound.asked == ["held"]
    page.mouse.up()


def test_a_hold_leaves_the_robots_voice_as_somebody_chose_it(page: Page, sound: NotedSound) -> None:
    hear = page.get_by_role("button", name=page_words("hear_here"))
    hear.click()
    sound.wait(lambda: sound.hears)
    hear.click()
    expect(hear).to_have_attribute("aria-pressed", "false")
    hold(page)
    sound.wait(lambda: sound.frames)
    page.mouse.up()
    sound.wait(lambda: "closed" in sound.asked)
    expect(hear).to_have_attribute("aria-pressed", "false")
    assert not sound.hears


def test_the_open_microphone_is_open_until_it_is_shut(page: Page, sound: NotedSound) -> None:
    button = page.get_by_role("button", name="Open microphone")
    button.click()
    sound.wait(lambda: len(sound.frames) >= 5)
    expect(button).to_have_attribute("aria-pressed", "true")
    button.click()
    sound.wait(lambda: "abandoned" in sound.asked)
    assert sound.asked == ["open", "abandoned"]


def test_a_page_that_hears_plays_what_is_said_and_falls_silent_with_the_robot(
    page: Page, sound: NotedSound
) -> None:
    page.evaluate(
        """async () => {
          const { Sound } = await import('/static/sound/sound.js');
          window.played = [];
          window.sound = new Sound(() => {});
          window.sound.onPlaying = (turn) => window.played.push(turn);
          await window.sound.connect();
          await window.sound.hear(true);
          const context = window.sound.context;
          window.meter = new AnalyserNode(context, { fftSize: 2048 });
          window.sound.player.connect(window.meter);
          window.loud = () => {
            const samples = new Float32Array(2048);
            window.meter.getFloatTimeDomainData(samples);
            return Math.max(...samples);
          };
        }"""
    )
    sound.wait(lambda: sound.hears)
    callback, flush = sound.hears[0]
    wave = (8000 * np.sin(np.arange(1600) * 0.4)).astype("<i2").tobytes()
    for turn in range(1, 1000):
        callback(turn, wave)
        if page.evaluate("window.played.length && window.loud() > 0.1"):
            break
        page.wait_for_timeout(50)
    assert page.evaluate("window.played[0]") >= 1
    flush()
    until(page, lambda: page.evaluate("window.loud()") == 0)


def test_a_microphone_that_is_refused_is_explained(page: Page, sound: NotedSound) -> None:
    page.evaluate(
        """() => { navigator.mediaDevices.getUserMedia = () =>
          Promise.reject(new DOMException('no', 'NotAllowedError')); }"""
    )
    hold(page)
    expect(page.locator(".sound")).to_contain_text(page_words("sound_denied"), timeout=PATIENCE_MS)
    page.mouse.up()
    assert sound.frames == []


@contextmanager
def phone(listening: Browser, rig: Rig) -> Iterator[Page]:
    """A phone that scanned the QR code of `edgevox-console pair --phone`, and paired."""
    context = listening.new_context(locale="en-GB", **PHONE)
    page = context.new_page()
    let_in(page, f"{rig.server.offer_code()[1]}&phone")
    page.locator(".first").wait_for()
    yield page
    context.close()


def start(page: Page) -> None:
    page.get_by_role("button", name=page_words("start"), exact=True).click()


def test_a_phone_that_is_let_in_hears_speaks_and_commands_after_one_tap(
    listening: Browser, rig: Rig, sound: NotedSound
) -> None:
    with phone(listening, rig) as page:
        start(page)
        page.locator(".lease button.on").wait_for()
        expect(page.locator(".first")).to_have_count(0)
        sound.wait(lambda: sound.hears)
        hear = page.get_by_role("button", name=page_words("hear_here"))
        expect(hear).to_have_attribute("aria-pressed", "true")
        assert "phone" not in page.url
        hold(page)
        sound.wait(lambda: sound.frames)
        assert sound.asked == ["held"]


def test_a_phone_goes_without_what_it_refuses_and_says_why(
    listening: Browser, rig: Rig, sound: NotedSound
) -> None:
    with phone(listening, rig) as page:
        page.evaluate(
            """() => { navigator.mediaDevices.getUserMedia = () =>
              Promise.reject(new DOMException('no', 'NotAllowedError')); }"""
        )
        page.get_by_role("switch", name=page_words("take_turn")).click()
        start(page)
        expect(page.locator(".first")).to_contain_text(page_words("sound_denied"))
        start(page)
        expect(page.locator(".first")).to_have_count(0)
        expect(page.locator(".lease button.primary")).to_be_visible()
        sound.wait(lambda: sound.hears)
