"""One server that hears for 1 to 20 robots, and the cost of a server that hangs.

The server stands in for a GPU: it takes 0.2 s for a sentence, one at a time. Each robot says a
sentence of three seconds, and the next one five seconds after its words. The stand-in for the model
on board marks its answers. At the end a real wyoming-faster-whisper is halted (SIGSTOP): the first
sentence of each robot shows what that costs.
"""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field

import numpy as np
from listener_rig import loud, says_espeak, silence
from ports import free_port
from speech_server import wyoming_speech
from waiting import wait_until
from wyoming.asr import Transcript as WyomingTranscript
from wyoming.event import Event
from wyoming.info import Describe, Info

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.many_robots import take_turns, waiting
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import Samples
from edgevox.voice.remote.hearing import open_hearing_server
from edgevox.voice.remote.shared_hearing import SharedSpeechToText
from edgevox.voice.stt.speech_to_text import Transcript

MODEL = "whisper-tiny.en"
TABLE = "One server that hears for many robots, with 0.2 s for a sentence"
SECONDS = {1: 15, 2: 15, 5: 15, 10: 20, 20: 25}
"""How long so many robots talk."""
ON_BOARD_S, WARM_S, HANGS = 0.5, 60.0, 5
TIMEOUT_S = float(Settings.model_fields["stt_endpoint_timeout"].default)
CARD_S = 0.2
SAID = (
    "go to the kitchen and then to the office please",
    "drive to the bedroom and come back to me",
)


class OnBoard:
    """Implements `SpeechToText`: it takes a fixed time."""

    def transcribe(self, samples: Samples, language: str) -> Transcript:  # noqa: ARG002 - see above
        time.sleep(ON_BOARD_S)
        return Transcript("on board")

    def warm_up(self, language: str) -> None: ...

    def close(self) -> None: ...


@dataclass(slots=True)
class Robot:
    """What one robot saw, in seconds from the end of a sentence to its words."""

    hearing: SharedSpeechToText
    waited_s: list[float] = field(default_factory=list)
    on_board: int = 0

    def hear(self, sound: Samples) -> None:
        """Have a sentence heard."""
        began_s = time.monotonic()
        said = self.hearing.transcribe(sound, "en").text
        self.waited_s.append(time.monotonic() - began_s)
        self.on_board += said == "on board"


def measure(quick: bool = False) -> Measured:
    """All numbers of robots, then a server that hangs."""
    sounds = [np.concatenate([loud(says_espeak(one, "en-us"), 0.1), silence(0.5)]) for one in SAID]
    figures = list[Figure]()
    with _card() as url:
        figures += _shared(url, sounds, quick=quick)
    with _server() as (url, server):
        first = open_hearing_server(Address(url, timeout_s=WARM_S))
        first.transcribe(sounds[0], "en", "", CancelToken())
        first.close()
        server.send_signal(signal.SIGSTOP)
        with _robots(url, HANGS) as robots:
            for robot in robots:
                robot.hear(sounds[0])
                assert robot.on_board
            beyond = [1000 * (one.waited_s[0] - ON_BOARD_S) for one in robots]
        server.send_signal(signal.SIGCONT)
    row = "a server that hangs, first sentence"
    figures.append(Figure.of("hang", TABLE, row, beyond, "ms", column="more than on board alone"))
    return Measured(figures=tuple(figures))


def _shared(url: str, sounds: Sequence[Samples], *, quick: bool) -> Iterator[Figure]:
    for count, seconds in [(1, 4), (5, 4)] if quick else SECONDS.items():
        with _robots(url, count) as robots:
            lasted_s = take_turns(robots, sounds, seconds, Robot.hear)
            yield from _figures(robots, lasted_s)


@contextmanager
def _robots(url: str, count: int) -> Iterator[list[Robot]]:
    """So many robots that share the server at this address."""
    made = [
        Robot(
            SharedSpeechToText(
                open_hearing_server(Address(url, timeout_s=TIMEOUT_S, setting="stt_endpoint")),
                OnBoard(),
            )
        )
        for _ in range(count)
    ]
    try:
        yield made
    finally:
        for one in made:
            one.hearing.close()


@contextmanager
def _card() -> Iterator[str]:
    """A server that transcribes one sentence at a time, and describes itself meanwhile."""
    one_at_a_time = threading.Lock()

    def turn(events: list[Event], send: Callable[[Event], None], _: object) -> None:
        if Describe.is_type(events[-1].type):
            send(Info().event())
            return
        with one_at_a_time:
            time.sleep(CARD_S)
        send(WyomingTranscript("from afar").event())

    with wyoming_speech(turn) as server:
        yield server.address("stt").url


@contextmanager
def _server() -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A server of Home Assistant's; its address and its process."""
    try:
        weights = locate(MODEL)
    except ModelMissing as error:
        raise NotHere(str(error)) from None
    port = free_port()
    url = f"tcp://127.0.0.1:{port}"
    with tempfile.TemporaryDirectory() as folder:
        command = [
            *(sys.executable, "-m", "wyoming_faster_whisper", "--uri", url, "--local-files-only"),
            *("--model", str(weights), "--stt-library", "faster-whisper", "--beam-size", "1"),
            *("--cpu-threads", str(os.cpu_count()), "--data-dir", folder),
        ]
        with subprocess.Popen(command, env=os.environ | {"HF_HUB_OFFLINE": "1"}) as process:
            try:
                wait_until(lambda: _listens(port))
                yield url, process
            finally:
                process.kill()


def _listens(port: int) -> bool:
    with closing(socket.socket()) as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def _figures(robots: Sequence[Robot], seconds: float) -> Iterator[Figure]:
    waits = [one for robot in robots for one in robot.waited_s]
    on_board = sum(robot.on_board for robot in robots)
    count = len(robots)
    row = f"{count} robot{'s' * (count > 1)}"
    for key, column, unit, value in (
        ("rate", "sentences", "/s", len(waits) / seconds),
        *waiting(waits),
        ("on-board", "heard on board", "%", 100 * on_board / len(waits)),
    ):
        yield Figure.of(f"{key}.{count}", TABLE, row, [value], unit, column=column)
