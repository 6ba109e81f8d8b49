"""A room with a robot that speaks and a person who may speak over it: what is played and heard.

The loop is closed: whoever interrupts silences the loudspeaker 0.1 s later, as the real sinks do.
"""

from dataclasses import dataclass, field

import numpy as np

from benchmarks.hearing.echo_paths import EchoPath, Sound, as_samples, noise_floor
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Heard, Interrupt, SpokenOver, StopSpotted
from edgevox.core.settings import Echo
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, EndOfSound, Frame, rms
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.listener import Listener
from edgevox.voice.stop_spotter.detector import StopDetector
from edgevox.voice.stt.speech_to_text import SpeechToText
from edgevox.voice.vad import open_vad
from edgevox.voice.word_detection import WakeDetector

SILENT_AFTER_S = 0.1
AHEAD_S = 0.1
BLOCK_S = 0.04
AFTERWARDS_S = 1.2
"""The microphone is heard for so long after the person, or after the robot, has ended."""


@dataclass(slots=True)
class Happened:
    """What the listener made of it."""

    held_s: list[float] = field(default_factory=list)
    """When it fell silent to listen; it goes on if that was nothing, such as "mm-hm"."""
    interrupted_s: list[float] = field(default_factory=list)
    heard: list[Heard] = field(default_factory=list)
    stopped_s: list[float] = field(default_factory=list)


class Room:
    """A source for the listener, and what its loudspeaker plays meanwhile.

    `beside` is heard all the time.
    """

    name = "room"

    def __init__(
        self,
        speech: Sound,
        path: EchoPath,
        person: Sound,
        person_s: float,
        *,
        yields: bool,
        beside: Sound | None = None,
    ) -> None:
        count = max(speech.size, round(person_s * RATE_HZ) + person.size)
        count += round(AFTERWARDS_S * RATE_HZ)
        self._speech = np.concatenate([speech, np.zeros(count - speech.size)])
        self._path, self._yields = path, yields
        self._gain = path.gain(self._speech)
        self._echo = path.echo(self._speech, self._gain)
        self._others = noise_floor(count, path.seed)
        at = round(person_s * RATE_HZ)
        self._others[at : at + person.size] += person
        if beside is not None:
            self._others += np.resize(beside, count)
        self._late = np.random.default_rng(path.seed)
        self._frames = self._played_blocks = 0
        self._cut_at = count
        self.played = PlayedSound()
        self.happened = Happened()

    @property
    def now_s(self) -> float:
        return self._frames * FRAME_S

    def audible(self) -> float:
        """How loud the loudspeaker is now."""
        at = self._frames * FRAME_SAMPLES
        return rms(as_samples(self._speech[max(0, at - FRAME_SAMPLES) : at]))

    def submit(self, command: Command) -> None:
        match command:
            case Heard():
                self.happened.heard.append(command)
            case StopSpotted():
                self.happened.stopped_s.append(self.now_s)
            case SpokenOver():
                self.happened.held_s.append(self.now_s)
                self._yield()
            case Interrupt():
                self.happened.interrupted_s.append(self.now_s)
                self._yield()

    def start(self) -> None: ...

    def close(self) -> None: ...

    def read(self, timeout_s: float) -> Frame | None:  # noqa: ARG002
        at = self._frames * FRAME_SAMPLES
        if at + FRAME_SAMPLES > self._speech.size:
            raise EndOfSound("room: over")
        self._frames += 1
        self._play_ahead()
        heard = self._echo[at : at + FRAME_SAMPLES] + self._others[at : at + FRAME_SAMPLES]
        return Frame(as_samples(heard), self.now_s + self._late.uniform(0, self._path.jitter_s))

    def _play_ahead(self) -> None:
        size = round(BLOCK_S * RATE_HZ)
        while self._played_blocks * BLOCK_S < self.now_s + AHEAD_S:
            at = self._played_blocks * size
            block = as_samples(self._speech[at : at + size])
            if block.any():
                self.played.add(block, RATE_HZ, at / RATE_HZ)
            self._played_blocks += 1

    def _yield(self) -> None:
        if self._yields and self._cut_at == self._speech.size:
            self._fall_silent()

    def _fall_silent(self) -> None:
        """Nothing is played from here on; the echo goes on as long as the way and the room are."""
        self._cut_at = round((self.now_s + SILENT_AFTER_S) * RATE_HZ)
        self._speech[self._cut_at :] = 0.0
        self._echo = self._path.echo(self._speech, self._gain)
        self.played.cut(self._cut_at / RATE_HZ)


def listen_in(
    room: Room,
    echo: Echo,
    stt: SpeechToText,
    spotter: StopDetector | None = None,
    wakeword: WakeDetector | None = None,
) -> Happened:
    """All that happens in it, to the end.

    The robot may be saying "stop" all the time, as far as who spots stop words is told.
    """
    listener = Listener(
        room,
        open_vad(),
        stt,
        submit=room.submit,
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=room.audible,
        wakeword=wakeword,
        stop_detector=spotter,
        saying=lambda: "stop",
        played=room.played,
        echo=echo,
        lossless=True,
    )
    listener.start()
    listener.wait_over()
    listener.close()
    return room.happened
