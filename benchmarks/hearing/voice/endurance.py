"""A whole agent that hears minute after minute of sound as fast as it can, and what it leaves.

The benchmark `voice` lets it hear an hour, a test five minutes.
"""

import gc
import statistics
import threading
import time
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from listener_rig import loud, says_espeak
from voice_rig import VoiceRig

from benchmarks.hearing.listening import quiet_room, resident_kib
from edgevox.core.commands import Speak
from edgevox.core.events import Responded, TurnMeasured
from edgevox.voice.audio import RATE_HZ, Samples

QUESTIONS = ("where are you", "what is your battery level")
MINUTE_S = 60.0
WARM_MINUTES = 2
"""Before what is loaded and cached is all there, growth is not counted."""
LONG = (
    "I am in the long corridor between the living room and the kitchen, right at x 6.4 and y 2.1."
)
"""Longer than any answer: a voice keeps as much memory as its longest phrase has taken."""
PATIENCE_S = 60.0


@dataclass(frozen=True, slots=True)
class Endured:
    """What so many minutes of sound left behind, the last quarter of them against the first.

    Memory is the least of a quarter, which leaves out what comes and goes; "late" is against the
    third quarter: Piper's arena grows in steps until it has met its largest sound. What half a
    minute with a turn in it took is the mean of a quarter: the two questions take unlike times, so
    that a median would tell which of them a quarter holds one more of. Work is the processor's time
    for that, which does not depend on what else the machine does.
    """

    minutes: int
    turns: int
    memory_growth_kib: int
    late_memory_growth_kib: int
    thread_growth: int
    first_took_s: float
    last_took_s: float
    first_work_s: float
    last_work_s: float


class _Turn(NamedTuple):
    took_s: float
    work_s: float


def minute() -> Samples:
    """A minute of a quiet room in which somebody asks two questions."""
    sound = quiet_room(MINUTE_S)
    for number, question in enumerate(QUESTIONS):
        spoken = loud(says_espeak(question, "en-us"), 0.08)
        start = int((5.0 + 30.0 * number) * RATE_HZ)
        sound[start : start + spoken.size] += spoken
    return np.asarray(sound, np.int16)


def endure(rig: VoiceRig, minutes: int) -> Endured:
    """Let it hear so many minutes after two to get warm; every question must be answered."""
    sound = minute()
    for _ in range(WARM_MINUTES):
        _hear(rig, sound)
        rig.parts.command_router.submit(Speak(LONG))
        assert rig.parts.conversation.wait_idle(PATIENCE_S)
    gc.collect()
    threads = threading.active_count()
    turns: list[_Turn] = []
    resident: list[int] = []
    for _ in range(minutes):
        turns += _hear(rig, sound)
        gc.collect()
        resident.append(resident_kib())
    part, quarter = max(2, len(turns) // 8 * 2), max(1, minutes // 4)
    first, final = turns[:part], turns[-part:]
    last = min(resident[-quarter:])
    return Endured(
        minutes,
        len(turns),
        last - min(resident[:quarter]),
        last - min(resident[-2 * quarter : -quarter] or resident),
        threading.active_count() - threads,
        statistics.fmean(turn.took_s for turn in first),
        statistics.fmean(turn.took_s for turn in final),
        statistics.fmean(turn.work_s for turn in first),
        statistics.fmean(turn.work_s for turn in final),
    )


def _hear(rig: VoiceRig, sound: Samples) -> list[_Turn]:
    """How long each half of a minute took, as fast as it is heard, to the end of its turn.

    A turn's own figures count from when its sound ended, which here is later than it is heard.
    """
    rig.events.clear()
    turns: list[_Turn] = []
    half = sound.size // len(QUESTIONS)
    for number in range(len(QUESTIONS)):
        begun_s, worked_s = time.perf_counter(), time.process_time()
        rig.room.play(sound[number * half : (number + 1) * half])
        rig.wait_for(TurnMeasured, lambda _, n=number: len(rig.of(TurnMeasured)) > n)
        turns.append(_Turn(time.perf_counter() - begun_s, time.process_time() - worked_s))
    assert len(rig.of(Responded)) == len(QUESTIONS), rig.of(Responded)
    return turns
