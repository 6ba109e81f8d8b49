"""Speech by the console beside speech by `audio_in`, in one agent in this process."""

import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from listener_rig import loud
from ports import free_port
from support.recordings import write_wav
from voice_rig import says

from benchmarks.console.browser import LOUD, monotonic_s, opened
from benchmarks.core.figures import Figure
from benchmarks.hearing.listening import quiet_room
from edgevox.apps.agent import build
from edgevox.apps.agent.voice import warm_up_hearing
from edgevox.apps.console.serve_console import serve_console
from edgevox.apps.robots import build_body
from edgevox.core.agent_events import ToolCalled
from edgevox.core.cancel import CancelToken
from edgevox.core.commands import ConversationCommand, Heard, Reset, Speak
from edgevox.core.settings import Settings
from edgevox.voice.audio import RATE_HZ, Chunk, Samples
from edgevox.voice.tts.voices import VoicePool
from edgevox.voice.wav import resampled

SAID = "go to the kitchen"
TOLD = "The kitchen is on the left, behind the sofa."
PIECE = 320
PATIENCE_S = 60.0
HEARS = """async () => {
  const { Sound } = await import('/static/sound/sound.js');
  const sound = new Sound(() => {});
  sound.onPlaying = () => noted.played.push(performance.timeOrigin + performance.now());
  await sound.connect();
  await sound.hear(true);
}"""
MICROPHONE_HZ = 48_000


class Spoken:
    """An agent in the apartment with a console, whose `audio_in` is pushed into here."""

    def __init__(self, folder: Path) -> None:
        self._stack = ExitStack()
        settings = Settings(
            ros2=True,
            audio_in="ros2",
            audio_out="none",
            llm="none",
            console=True,
            console_tls="off",
            console_port=free_port(),
            console_folder=str(folder),
        )
        body = build_body("robot-apartment", settings)
        self.parts = build.build_parts(self._stack, settings, body)
        self.voice = self.parts.voice
        self.acted, self.acted_s = threading.Event(), 0.0
        self.due_s = 0.0
        self.parts.bus.subscribe(ToolCalled, self._act)
        self.words_s = 0.0
        """How long the last words took to be understood."""
        self._note_words()
        self._note_what_is_due()
        for part in (body, self.voice.speech_output, self.parts.conversation, self.parts.listener):
            build.start(self._stack, part)
        printed = StringIO()
        with redirect_stdout(printed):
            serve_console(self._stack, self.parts)
        self.link = next(word for word in printed.getvalue().split() if "#pair=" in word)
        warm_up_hearing(self.voice, "en")
        self.voice.speech_output.warm_up()

    def close(self) -> None:
        """End all of it."""
        self._stack.close()

    def forget(self) -> None:
        """As if nothing had been said."""
        self.parts.conversation.submit(Reset())
        self.parts.conversation.wait_idle()
        self.acted.clear()

    def _act(self, _: ToolCalled) -> None:
        self.acted_s = time.monotonic()
        self.acted.set()

    def _note_words(self) -> None:
        submit = self.parts.conversation.submit

        def noted(command: ConversationCommand, *given: Any) -> None:
            if isinstance(command, Heard):
                self.words_s = command.stt_s
            submit(command, *given)

        self.parts.conversation.submit = noted  # type: ignore[method-assign]

    def _note_what_is_due(self) -> None:
        """When the loudspeaker is due to play the first piece of an utterance."""
        play = self.voice.sink.play

        def noted(chunk: Chunk, token: CancelToken) -> float:
            began_s = time.monotonic()
            start_s = play(chunk, token)
            self.due_s = self.due_s or max(began_s, start_s)
            return start_s

        self.voice.sink.play = noted  # type: ignore[method-assign]


def speech(table: str, rounds: int) -> Iterator[Figure]:
    """Both ways in, and the way out."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spoken = Spoken(folder)
        try:
            said = loud(says("en", "af_bella", SAID, VoicePool()), 0.08)
            plain, paged = [], []
            with opened(spoken.link, _written(folder, said)) as page:
                for _ in range(rounds):  # in turns: what else the machine does slows both
                    paged.append(1000 * _paged_s(spoken, page))
                    page.reload()
                    plain.append(1000 * _pushed_s(spoken, said))
                first = [*_first_sounds_ms(spoken, page, rounds)]
        finally:
            spoken.close()
    yield Figure.of(
        "speech_plain",
        table,
        "end of speech to the action but for its words, by audio_in",
        plain,
        "ms",
    )
    yield Figure.of("speech_page", table, "the same, said into the page", paged, "ms")
    more = float(np.median(paged) - np.median(plain))
    yield Figure.of("speech_more", table, "by so much later", [more], "ms", wanted=100.0)
    yield Figure.of(
        "first_sound",
        table,
        "first sound in the browser after the loudspeaker's",
        first,
        "ms",
        wanted=120.0,
    )


def _pushed_s(spoken: Spoken, said: Samples) -> float:
    """Pushed as a node would, in pieces of 20 ms at the pace of speech."""
    spoken.forget()
    sound = np.concatenate([quiet_room(1.0), said, quiet_room(3.0)])
    last_s, next_s = 0.0, time.monotonic()
    for at in range(0, sound.size - PIECE, PIECE):
        next_s += PIECE / RATE_HZ
        time.sleep(max(0.0, next_s - time.monotonic()))
        piece = sound[at : at + PIECE]
        if np.abs(piece.astype(int)).max() > LOUD:
            last_s = time.monotonic()
        spoken.voice.microphone.push(piece)
    assert spoken.acted.wait(PATIENCE_S), "what was said was not understood"
    return spoken.acted_s - spoken.words_s - last_s


def _written(folder: Path, said: Samples) -> Path:
    """What the microphone of a browser plays, once from when it is opened."""
    sound = np.concatenate([quiet_room(2.0), said, quiet_room(8.0)])
    heard = resampled(sound, RATE_HZ, MICROPHONE_HZ)
    return write_wav(folder / "said.wav", heard, rate_hz=MICROPHONE_HZ)


def _paged_s(spoken: Spoken, page: Any) -> float:
    """Into a microphone that is opened anew."""
    page.reload()
    page.locator("html[data-link=ready]").wait_for()
    page.locator(".lease button.on").wait_for()
    spoken.forget()
    page.get_by_role("button", name="Open microphone").click()
    _wait(page, spoken.acted.is_set)
    page.wait_for_timeout(1000)
    return spoken.acted_s - spoken.words_s - monotonic_s(page.evaluate("noted.loud"))


def _first_sounds_ms(spoken: Spoken, page: Any, rounds: int) -> Iterator[float]:
    page.reload()
    page.locator("html[data-link=ready]").wait_for()
    page.evaluate(HEARS)
    page.wait_for_timeout(1000)
    for _ in range(rounds):
        spoken.forget()
        page.evaluate("noted.played.length = 0")
        spoken.due_s = 0.0
        spoken.parts.conversation.submit(Speak(TOLD))
        _wait(page, lambda: page.evaluate("noted.played.length"))
        yield 1000 * (monotonic_s(page.evaluate("noted.played[0]")) - spoken.due_s)
        spoken.parts.conversation.wait_idle()
        page.wait_for_timeout(500)


def _wait(page: Any, true: Any) -> None:
    until_s = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < until_s, "it did not come"
        page.wait_for_timeout(20)
