"""Talks to a robot and takes a picture of its full-screen terminal: docs/images/tui.svg.

Voice, speech recognition, model and robot are the real ones; a WAV file of a synthetic voice is the
microphone, and nobody hears what the robot says. Takes about a minute.
"""

import asyncio
import re
import tempfile
import wave
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from edgevox.apps.agent.build import AgentParts, build_parts, start_parts
from edgevox.apps.robots import build_body
from edgevox.apps.terminal.screen import Face
from edgevox.apps.terminal.slash_commands import SlashContext
from edgevox.apps.terminal.view import UpdateBuffer
from edgevox.core.cancel import CancelToken
from edgevox.core.settings import load_settings
from edgevox.models import locate
from edgevox.voice.audio import Samples
from edgevox.voice.tts.piper import PiperSynthesiser

IMAGE = Path(__file__).parent / "images" / "tui.svg"
SIZE = (120, 44)
SPOKEN = (
    ("Where are you?", 12.0),
    ("I am so tired, I could fall asleep right here.", 16.0),
    ("Please drive to the garage.", 10.0),
    ("How full is your battery?", 7.0),
    ("Please go to the kitchen.", 30.0),
)
"""What is said, and how many seconds until the next."""
FIRST_S = 1.0
ROOM_NOISE = 60.0
"""Standard deviation of what the microphone hears when nobody speaks, of 16 bit samples."""
LIMIT_S = 120.0
FONTS = re.compile(r"@font-face {.*?}\s*", re.DOTALL)
"""What would be loaded from elsewhere by whoever looks at the picture."""


def main() -> None:
    """Take the picture."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        heard = Path(folder) / "heard.wav"
        speak_into(heard)
        settings = load_settings({"audio_in": str(heard), "audio_out": "none"})
        parts = build_parts(stack, settings, build_body("robot-apartment", settings))
        updates = UpdateBuffer(parts.bus, parts.controls)
        stack.callback(updates.close)
        start_parts(stack, parts)
        IMAGE.write_text(FONTS.sub("", asyncio.run(screenshot(parts, updates))), encoding="utf-8")


async def screenshot(parts: AgentParts, updates: UpdateBuffer) -> str:
    """The screen, as SVG, when the last drive is under way and its sentence is over."""
    context = SlashContext(
        parts.conversation, parts.body, skills=parts.skills, software_stop=parts.software_stop
    )
    face = Face(updates, context, parts.queries, parts.command_router.submit, name=parts.name)
    async with face.run_test(size=SIZE) as pilot:
        await until(lambda: goes_to_the_kitchen(parts))
        await pilot.pause()
        updates.changed = lambda: None
        return face.export_screenshot(title="edgevox-agent robot-apartment")


def goes_to_the_kitchen(parts: AgentParts) -> bool:
    """Whether it is half way there."""
    state = parts.body.state() if parts.body else {}
    goal = state.get("goal")
    return bool(goal and goal["x"] > 5.0 and goal["progress"] > 0.5)


async def until(condition: Callable[[], bool]) -> None:
    """Wait for it."""
    async with asyncio.timeout(LIMIT_S):
        while not condition():
            await asyncio.sleep(0.05)


def speak_into(file: Path) -> None:
    """Write all that is said, with a room's noise under it."""
    voice = PiperSynthesiser(locate("piper-en_US-joe-medium"))
    silences = (FIRST_S, *(pause_s for _, pause_s in SPOKEN))
    parts: list[Samples] = [np.zeros(round(silences[0] * voice.sample_rate_hz), np.int16)]
    for words, pause_s in SPOKEN:
        parts += [chunk.samples for chunk in voice.synthesise(words, CancelToken())]
        parts.append(np.zeros(round(pause_s * voice.sample_rate_hz), np.int16))
    speech = np.concatenate(parts) * 0.5
    noise = np.random.default_rng(1).normal(0.0, ROOM_NOISE, len(speech))
    with wave.open(str(file), "wb") as out:
        out.setparams((1, 2, voice.sample_rate_hz, 0, "NONE", ""))
        out.writeframes((speech + noise).astype("<i2").tobytes())


if __name__ == "__main__":
    main()
