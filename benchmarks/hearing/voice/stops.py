"""A spoken stop word, while the robot drives: how long after the word it stands, and who heard it.

Voices are those held out from the spotter's training (`training.acoustics`), in quiet.
"""

import itertools
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from listener_rig import loud

from benchmarks.core.figures import Figure
from benchmarks.hearing.listening import quiet_room
from benchmarks.hearing.voice.turns import CLOCK, Talk
from edgevox.core.agent_events import HeardBy, SafetyPreempted
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples
from training.acoustics import Half
from training.acoustics.voices import kokoro_voices, say

WORDS = ("Stop!", "Halt!", "Freeze!")
ROOMS = ("bedroom", "kitchen")
WANTED_S, WANTED_WORST_S = 0.35, 0.5
PATIENCE_S = 4.0
SILENT_S = 1.5
LOOKED_S = 0.004
STANDS = 1e-3
"""m/s and rad/s: what is slower stands."""


@dataclass(frozen=True, slots=True)
class SpokenStop:
    """What became of one: seconds from the end of the word until it stood, None if it drove on."""

    said: str
    after_s: float | None
    heard_by: HeardBy | None


def spoken_stops(talk: Talk, quick: bool) -> list[SpokenStop]:
    """Each word by each voice that is held out."""
    voices = kokoro_voices(Half.HELD_OUT)[: 2 if quick else None]
    rooms = itertools.cycle(ROOMS)
    return [
        _stop(talk, f"{text} ({voice})", loud(say(voice, text), 0.08), next(rooms))
        for voice in voices
        for text in WORDS
    ]


def stop_figures(table: str, stops: Sequence[SpokenStop]) -> Iterator[Figure]:
    """How soon, the worst, how many were missed, and how many the spotter heard."""
    took = [one.after_s for one in stops if one.after_s is not None]
    what = "spoken stop word, while it drives"
    if took:
        yield Figure.of(
            "stop", table, f"{what}: its end to zero velocity", took, "s", wanted=WANTED_S
        )
        yield Figure.of(
            "stop_worst", table, f"{what}: the worst", [max(took)], "s", wanted=WANTED_WORST_S
        )
    for name, label, count in (
        ("stop_missed", "heard by nobody", sum(one.after_s is None for one in stops)),
        ("stop_spotted", "by its sound", sum(one.heard_by is HeardBy.SPOTTER for one in stops)),
    ):
        yield Figure.of(name, table, f"{what}: {label}, of {len(stops)}", [count], "")


def _stop(talk: Talk, said: str, word: Samples, room: str) -> SpokenStop:
    _hear_out(talk)
    heard_by: list[HeardBy] = []
    forget = talk.parts.bus.subscribe(SafetyPreempted, lambda one: heard_by.append(one.heard_by))
    talk.parts.conversation.start_goal("navigate_to", {"room": room})
    sound = np.concatenate([quiet_room(2.0), word, quiet_room(PATIENCE_S)])
    word_ends = quiet_room(2.0).size + word.size
    started_s, number = CLOCK.now(), 0
    moved = False
    try:
        while (at := number * FRAME_SAMPLES) + FRAME_SAMPLES <= sound.size:
            now_s = CLOCK.now() - started_s
            if now_s >= (at + FRAME_SAMPLES) / RATE_HZ:
                talk.voice.microphone.push(sound[at : at + FRAME_SAMPLES])
                number += 1
            elif moved and heard_by and _stands(talk):
                return SpokenStop(said, now_s - word_ends / RATE_HZ, heard_by[0])
            else:
                moved = moved or not _stands(talk)
                threading.Event().wait(LOOKED_S)
        return SpokenStop(said, None, None)
    finally:
        forget()


def _hear_out(talk: Talk) -> None:
    """What was said before is over, understood and answered: it stops no drive that begins now."""
    talk.play(quiet_room(SILENT_S))
    talk.parts.listener.transcriber.wait_idle()
    talk.rest()


def _stands(talk: Talk) -> bool:
    twist = talk.body.velocity()
    return abs(twist.linear_m_s) < STANDS and abs(twist.angular_rad_s) < STANDS
