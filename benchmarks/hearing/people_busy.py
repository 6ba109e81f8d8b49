"""Real people's orders, in real time, while another process takes one of two cores.

Held-out speakers of `people` order, half of them in quiet and half in noise at 12 dB. Their sound
comes to the product's listener in real time; voice activity, the stop word spotter, Whisper, the
judge of endings and the interpreter share two cores. Each order is heard twice: beside a process
that takes all the time that it can get, and without one. An order that words ended too early, and
whose rest is heard, is taken back, as the robot does.
"""

import math
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from typing import Self

import numpy as np

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.heard_robot import Outcome, Robot
from benchmarks.hearing.listening import quiet_room
from benchmarks.hearing.people import barista, in_noise, orders, recording
from edgevox.agent.nlu.hearing.endings import Endings
from edgevox.agent.skills import Call
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Command, Heard, SpokenOn
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Samples
from edgevox.voice.listener import Listener
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.speech_to_text import Transcript
from edgevox.voice.vad import open_vad
from training.acoustics import Half

TABLE = "People's orders in real time on two cores"
ALONE, BUSY = "alone", "beside a busy process"
WORST = tuple(Outcome)
ORDERS = 40
CORES = 2
CONDITIONS = ("quiet", "12 dB")
AFTERWARDS_S = 2.0
"""Quiet after each order: longer than any utterance is waited for."""
LEAST_SHARE = 0.9
"""Of the orders that are done, or rightly asked about, without the busy process."""


@dataclass(frozen=True, slots=True)
class Ordered:
    """What became of an order, and how long after its last sound that was known."""

    outcome: Outcome
    after_s: float

    @property
    def good(self) -> bool:
        """Whether it is done, or rightly asked about."""
        return self.outcome in (Outcome.RIGHT, Outcome.ASKED)


class Waiter:
    """A robot that takes orders, and the microphone in front of it."""

    def __init__(self) -> None:
        self._robot, self._clock = Robot("barista", skills=barista()), SystemClock()
        self._microphone = Pushed("microphone", self._clock)
        self._commands: queue.SimpleQueue[Command | threading.Event | None] = queue.SimpleQueue()
        self._ordered: dict[float, Ordered] = {}
        self._wanted = Call("none")
        spotter = open_stop_spotter(locate(ENCODER))
        spotter.warm_up()
        interpreter = self._robot.interpreter
        judge = Endings(
            interpreter.plain, is_stop=_is_stop, hearing=lambda: interpreter.phrases.hearing
        )
        self._listener = Listener(
            self._microphone, open_vad(), self._robot.whisper, submit=self._commands.put, bus=Bus(),
            language=lambda: "en", muted=lambda: False, audible=lambda: 0.0, is_stop=_is_stop,
            stop_detector=spotter, ending=judge.of,
        )  # fmt: skip
        self._thread = threading.Thread(target=self._understand, name="waiter")

    def __enter__(self) -> Self:
        self._robot.whisper.warm_up("en")
        self._listener.start()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._listener.close()
        self._commands.put(None)
        self._thread.join()

    def hear(self, sound: Samples, wanted: Call) -> Ordered:
        """What becomes of what is said in real time, once all of it is understood."""
        self._ordered.clear()
        self._wanted = wanted
        self._say(np.concatenate([sound, quiet_room(AFTERWARDS_S)]))
        self._listener.transcriber.wait_idle()
        understood = threading.Event()
        self._commands.put(understood)
        understood.wait()
        several = [*self._ordered.values()]
        outcome = min((one.outcome for one in several), key=WORST.index, default=Outcome.NOTHING)
        return Ordered(outcome, max((one.after_s for one in several), default=math.nan))

    def _say(self, sound: Samples) -> None:
        begun_s = self._clock.now()
        for number in range(sound.size // FRAME_SAMPLES):
            time.sleep(max(0.0, begun_s + (number + 1) * FRAME_S - self._clock.now()))
            self._microphone.push(sound[number * FRAME_SAMPLES : (number + 1) * FRAME_SAMPLES])

    def _understand(self) -> None:
        while command := self._commands.get():
            match command:
                case Heard():
                    said = Transcript(
                        command.text, command.confidence, command.others, command.rate
                    )
                    outcome = self._robot.does([said] if said.text else [], self._wanted)
                    after_s = self._clock.now() - command.ended_s
                    self._ordered[command.ended_s] = Ordered(outcome, after_s)
                case SpokenOn():
                    self._ordered.pop(command.ended_s, None)
                case threading.Event():
                    command.set()


def measure(quick: bool = False) -> Measured:
    """Every order beside the busy process and without it, in turns. Raises `NotHere`."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(cores)[:CORES])
    try:
        return Measured(figures=tuple(_figures(_measured(quick))))
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    finally:
        os.sched_setaffinity(0, cores)


def _measured(quick: bool) -> dict[str, list[Ordered]]:
    every = orders(Half.HELD_OUT)
    every = every[:: len(every) // ORDERS][: 4 if quick else ORDERS]
    found: dict[str, list[Ordered]] = {ALONE: [], BUSY: []}
    with Waiter() as waiter:
        for number, order in enumerate(every):
            condition = CONDITIONS[number % len(CONDITIONS)]
            sound = in_noise(recording(order.file), condition, order.file.name)
            for beside, several in found.items():
                with _busy_process() if beside == BUSY else nullcontext():
                    several.append(waiter.hear(sound, order.wanted))
    return found


@contextmanager
def _busy_process() -> Iterator[None]:
    process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def _figures(found: Mapping[str, Sequence[Ordered]]) -> Iterator[Figure]:
    alone = sum(one.good for one in found[ALONE])
    for beside, several in found.items():
        key = beside.split()[-1]
        good, wanted = sum(one.good for one in several), LEAST_SHARE * 100 * alone / len(several)
        yield Figure.share(
            f"good.{key}", TABLE, beside, good, len(several), column="right, or asked back",
            more_is_better=True, wanted=round(wanted, 1) if beside == BUSY else None,
        )  # fmt: skip
        for outcome in Outcome:
            yield Figure.share(
                f"{outcome.name.lower()}.{key}", TABLE, beside,
                sum(one.outcome is outcome for one in several), len(several),
                column=outcome.value, more_is_better=outcome is Outcome.RIGHT,
            )  # fmt: skip
        after = [one.after_s for one in several if not math.isnan(one.after_s)]
        yield Figure.of(
            f"after.{key}", TABLE, beside, after, "s", column="understood after its last word"
        )


def _is_stop(text: str) -> bool:
    return find_stop_word("en", text) is not None


if __name__ == "__main__":
    sys.exit(printed("people_busy", measure))
