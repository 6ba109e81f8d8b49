"""A Chromium whose microphone plays a file, and the files for it."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from browser_rig import let_in, take_the_turn
from playwright.sync_api import Browser, Page, Playwright
from support.recordings import write_wav

from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate
from edgevox.voice.tts.voices import VoiceChoice, VoicePool
from edgevox.voice.wav import resampled

RATE_HZ = 48_000
PATIENCE_MS = 120_000


def tone(hertz: float, seconds: float) -> np.ndarray:
    """A sine, half as loud as may be."""
    times = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    return (16_000 * np.sin(2 * np.pi * hertz * times)).astype(np.int16)


def spoken(text: str) -> np.ndarray:
    """Words, in the voice that is always here."""
    language = LANGUAGES["en"]
    named = next(one for one in language.voices if all("piper" in model for model in one.models))
    choice = VoiceChoice("en", named, tuple(locate(model) for model in named.models))
    chunks = VoicePool().get(choice).synthesise(text, CancelToken())
    return np.concatenate([resampled(one.samples, one.rate_hz, RATE_HZ) for one in chunks])


def silence(seconds: float) -> np.ndarray:
    return np.zeros(round(seconds * RATE_HZ), np.int16)


def write(path: Path, *sounds: np.ndarray) -> Path:
    return write_wav(path, *sounds, rate_hz=RATE_HZ)


def launch(playwright: Playwright, *flags: str) -> Browser:
    found = shutil.which("chromium")
    assert found, "Debian's chromium is needed: apt-get install chromium"
    return playwright.chromium.launch(executable_path=found, args=["--no-sandbox", *flags])


@contextmanager
def microphone(playwright: Playwright, sound: Path) -> Iterator[Browser]:
    """A browser that hears this file, from when it is first listened to, over and over."""
    browser = launch(
        playwright,
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-audio-capture={sound}",
        "--autoplay-policy=no-user-gesture-required",
    )
    yield browser
    browser.close()


@contextmanager
def paired(browser: Browser, link: str) -> Iterator[Page]:
    """A page that is let in and commands; what breaks in it fails the test."""
    context = browser.new_context(locale="en-GB", viewport={"width": 1440, "height": 900})
    context.set_default_timeout(PATIENCE_MS)
    broken: list[str] = []
    page = context.new_page()
    page.on("pageerror", lambda error: broken.append(str(error)))
    let_in(page, link)
    take_the_turn(page)
    yield page
    context.close()
    assert not broken, broken
