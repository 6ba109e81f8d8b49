"""What a person says while the robot speaks: what encourages it to go on, and what interrupts it.

The robot speaks by Piper, in the six ways of `duplex` from loudspeaker to microphone, echo
cancelled; it has spoken for 5 s. People are the English voices of Kokoro and espeak-ng that nothing
was tuned with, and, where `EDGEVOX_PEOPLE` is there, real people of the half that is kept apart who
order coffee. "Mm-hm" and the like are of synthetic voices: no free recordings of them were found.

Decided as in the product: the robot falls silent for a voice, goes on if the words encourage it or
if there are none, and ends what it says otherwise, or once the voice lasts for more than a second.
Time is that of the sound, with 0.25 s for words to be recognised.
"""

import itertools
import os
from collections.abc import Callable, Iterator, Sequence
from types import SimpleNamespace
from typing import Any

from corpus_robots import skills_of_robots

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing import people
from benchmarks.hearing.duplex import begins_s, own_voice, person, way_of
from benchmarks.hearing.duplex_room import Happened, Room, listen_in
from benchmarks.hearing.echo_paths import Sound
from benchmarks.hearing.endings import STT_S, endings, recogniser
from edgevox.agent.agents import Agent
from edgevox.agent.dialogue.asking import Asking
from edgevox.agent.dialogue.memory import LastDrive
from edgevox.agent.dialogue.question import OpenQuestion
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Rate
from edgevox.core.speech import Ending
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import FULL_SCALE
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.speech_to_text import SpeechToText
from edgevox.voice.utterance_end import EARLY_S, ENDS_AFTER_S
from training.acoustics import Half
from training.acoustics.voices import espeak_voices, native_voices, say

TABLE = "Words over the robot's own voice"
ENCOURAGING = (
    "Mm-hm.", "Uh-huh.", "Yeah.", "Okay.", "Right.", "I see.", "Got it.", "Sure.", "Oh, wow.",
)  # fmt: skip
INTERRUPTING = (
    "Wait.", "No.", "Stop.", "Hold on.", "Not there.", "Go to the kitchen.", "Where are you?",
    "Turn around.", "Listen to me.",
)  # fmt: skip
BEGINS_S, MOST_ORDERS = 5.0, 60
KINDS = {
    "encouraging": ("words that encourage it: it goes on", 95.0),
    "interrupting": ("words that interrupt it: it ends what it says", 99.0),
    "orders": ("real people's orders: it ends what it says", 99.0),
}


def measure(quick: bool = False) -> Measured:
    """Each kind of words. Raises `NotHere` without a model."""
    voices = (*native_voices(Half.HELD_OUT), *espeak_voices(Half.HELD_OUT)[::17])
    voices = voices[:: 6 if quick else 1]
    try:
        stt = recogniser()
        said = {
            "encouraging": [_spoken(*one) for one in itertools.product(voices, ENCOURAGING)],
            "interrupting": [_spoken(*one) for one in itertools.product(voices, INTERRUPTING)],
        }
        if people.FOLDER in os.environ:
            orders = people.orders(Half.HELD_OUT)[: 6 if quick else MOST_ORDERS]
            said["orders"] = [people.recording(one.file) / FULL_SCALE for one in orders]
        figures = [one for kind, sounds in said.items() for one in _figures(kind, sounds, stt)]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figures))


def _spoken(voice: str, text: str) -> Sound:
    return say(voice, text) / FULL_SCALE


def _figures(kind: str, sounds: Sequence[Sound], stt: SpeechToText) -> Iterator[Figure]:
    encourages, ending, goes_on = _encourages(), endings().of, kind == "encouraging"
    right, noticed, silent_s, over_s = 0, 0, list[float](), list[float]()
    for number, sound in enumerate(sounds):
        path, at_s = way_of(number), begins_s(number, BEGINS_S)
        room = Room(own_voice(at_s + 3.0, number), path, person(sound, path), at_s, yields=True)
        happened = listen_in(room, "cancel", stt, open_stop_spotter(locate(ENCODER)))
        ends = bool(happened.interrupted_s or happened.stopped_s) or not all(
            encourages(one.text, one.confidence, one.rate) for one in happened.heard
        )
        right += not ends if goes_on else ends
        if happened.held_s:
            noticed += 1
            silent_s.append(happened.held_s[0] - at_s)
            over_s += _goes_on_after(happened, ending) if goes_on and not ends else ()
    what, wanted = KINDS[kind]
    yield Figure.share(
        f"{kind}.right", TABLE, what, right, len(sounds), more_is_better=True, wanted=wanted
    )
    yield Figure.share(
        f"{kind}.silent", TABLE, f"{what.partition(':')[0]}: it falls silent", noticed, len(sounds)
    )
    yield Figure.of(
        f"{kind}.after", TABLE, f"{what.partition(':')[0]}: silent after", silent_s, "s", wanted=0.3
    )
    if over_s:
        yield Figure.of(f"{kind}.goes_on", TABLE, "and goes on after", over_s, "s", wanted=2.0)


def _goes_on_after(happened: Happened, ending: Callable[[str], Ending]) -> Iterator[float]:
    """Seconds from its silence until it goes on."""
    for one in happened.heard[:1]:
        silence_s = max(ENDS_AFTER_S[ending(one.text)], EARLY_S + STT_S)
        yield one.ended_s - happened.held_s[0] + silence_s


def _encourages() -> Callable[[str, float, Rate | None], bool]:
    """Whether words, heard so surely, let a robot go on that has asked nothing."""
    bus, clock = Bus(), SystemClock()
    agent = Agent("robot", "", skills_of_robots()["robot-apartment"])
    unused: Any = SimpleNamespace(last=LastDrive(bus, clock))  # it carries nothing out
    question = OpenQuestion(bus, clock)
    return Asking(Interpreter([agent], bus, clock), unused, unused, question).encourages
