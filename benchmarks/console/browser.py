"""A real browser for the benchmark of the console, which notes by its own clock what happens."""

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.core.figures import NotHere

NOTES = """
window.noted = { ready: 0, pressed: [], live: [], played: [], loud: 0, sent: 0 };
const now = () => performance.timeOrigin + performance.now();
new MutationObserver(() => {
  if (document.documentElement?.dataset.link === 'ready') noted.ready ||= performance.now();
}).observe(document, { subtree: true, attributes: true, attributeFilter: ['data-link'] });
document.addEventListener('pointerdown', () => noted.pressed.push(now()), { capture: true });
window.WebSocket = class extends WebSocket {
  constructor(...given) {
    super(...given);
    this.addEventListener('message', ({ data }) => {
      if (typeof data !== 'string' || !data.includes('"live"')) return;
      const told = JSON.parse(data);
      if (told.type === 'live') noted.live.push([told.time, now()]);
    });
  }
  send(data) {
    if (data instanceof Uint8Array && data.length === 648) {
      const samples = new Int16Array(data.buffer, 8);
      noted.sent++;
      if (samples.some((one) => Math.abs(one) > LOUD)) noted.loud = now();
    }
    super.send(data);
  }
};
"""
"""What the page notes, in milliseconds since 1970: put in before its own scripts."""
LOUD = 1000
"""A sample of speech; the room's noise is softer."""
PATIENCE_MS = 60_000


def monotonic_s(since_1970_ms: float) -> float:
    """The same moment by this process's clock."""
    return since_1970_ms / 1000 - time.time() + time.monotonic()


@contextmanager
def opened(link: str, sound: Path | None = None) -> Iterator[Any]:
    """A page that is let in by the link and commands; its microphone plays the file. A `Page`."""
    found = shutil.which("chromium")
    if not found:
        raise NotHere("there is no chromium: apt-get install chromium")
    from browser_rig import let_in, take_the_turn
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--autoplay-policy=no-user-gesture-required"]
    flags += ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream"]
    if sound:
        flags.append(f"--use-file-for-fake-audio-capture={sound}%noloop")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=flags)
        page = browser.new_page(locale="en-GB")
        page.set_default_timeout(PATIENCE_MS)
        page.add_init_script(NOTES.replace("LOUD", str(LOUD)))
        let_in(page, link)
        take_the_turn(page)
        yield page
        browser.close()
