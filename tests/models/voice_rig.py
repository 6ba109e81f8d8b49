"""A whole agent with speech in and out in this process, and a room that the test fills with sound.

It is put together as the program does it; only the microphone is a `Room`, and the answers go into
a WAV file as fast as they are made, or aloud against the clock.
"""

import threading
import time
from collections import deque
from contextlib import ExitStack
from functools import cache
from pathlib import Path

import numpy as np
from guards import HUNG_S
from listener_rig import silence
from support.recordings import UnpacedWav
from voice_engines import speak, voice
from waiting import Heard

from edgevox.apps.agent import build
from edgevox.apps.agent import voice as voice_app
from edgevox.apps.agent.models import open_decider
from edgevox.apps.robots import build_body
from edgevox.core.agent_events import AgentEvent, ToolCalled
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Reset
from edgevox.core.events import (
    AudioLevel,
    Responded,
    StateChanged,
    Transcribed,
    TurnEnded,
    TurnMeasured,
)
from edgevox.core.settings import Settings
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, EndOfSound, Frame
from edgevox.voice.sinks.open_sink import WavFile
from edgevox.voice.tts.voices import VoicePool
from edgevox.voice.wav import resampled, stream_wav

SEEN = (
    AgentEvent,
    AudioLevel,
    Responded,
    StateChanged,
    Transcribed,
    TurnEnded,
    TurnMeasured,
)

QUIET_S = 2.0
"""More silence than any utterance is waited for to go on."""
SLOWLY = 0.2
"""The speed of a world in which a drive goes on for longer than it takes to hear and to answer."""


shared_decider = cache(open_decider)
"""Its encoder takes a quarter of a GB, and a second to read."""


def whole_wav(path):
    """All of a WAV file, at 16 kHz."""
    return np.concatenate([*stream_wav(path)])


class Room:
    """A source that hears what the test plays: as fast as it is read, or `paced` by the clock.

    Where the robot's own voice counts, which is played by the clock, the room must be paced too.
    However fast or slowly it is read, a frame is as long after the last one as it is in sound: what
    is said 2 s after a stop word was not said within the same second, and who reads late has missed
    nothing. What is played next comes later by the clock, too.
    """

    name = "room"

    def __init__(self, *, paced=False):
        self._paced = paced
        self._frames = deque()
        self._changed = threading.Condition()
        self._asked = self._closed = self._anew = False
        self.played = False
        """Whether there was any sound since somebody last set this back."""
        self._end_s = 0.0

    def start(self):
        pass

    def play(self, sound):
        """Sound in the room, and wait until all of it was heard."""
        whole = sound[: sound.size // FRAME_SAMPLES * FRAME_SAMPLES]
        with self._changed:
            self._frames.extend(whole.reshape(-1, FRAME_SAMPLES))
            self._asked, self._anew, self.played = False, True, True
            self._changed.notify_all()
            assert self._changed.wait_for(lambda: self._asked, HUNG_S), (
                "the listener does not listen"
            )

    def read(self, timeout_s):
        if self._paced and self._frames:
            time.sleep(FRAME_S)
        with self._changed:
            self._asked = not self._frames
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._frames or self._closed, timeout_s)
            if self._closed:
                raise EndOfSound("room: over")
            if not self._frames:
                return None
            self._end_s += FRAME_S
            if self._paced or self._anew:
                self._end_s, self._anew = max(SystemClock().now(), self._end_s), False
            return Frame(self._frames.popleft(), self._end_s)

    def close(self):
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class VoiceRig:
    """The agent, what it told, and what it said aloud. Its world's time passes at this speed."""

    def __init__(
        self, patch, answers: Path, *, aloud=False, robot="", model=None, speed=1.0, **more
    ):
        self.room = Room(paced=aloud)
        patch.setattr(voice_app, "open_source", lambda _: self.room)
        if not aloud:
            patch.setattr(voice_app, "open_sink", lambda spec, **_: UnpacedWav(WavFile(Path(spec))))
        patch.setattr(build, "open_decider", shared_decider)
        if model:
            patch.setattr(build, "open_model", lambda *_: model)
        settings = Settings(audio_in="room", audio_out=str(answers), llm="none", **more)
        self._answers, self._heard = answers, 0
        self._stack = ExitStack()
        self.body = build_body(robot, settings, speed) if robot else None
        self.parts = build.build_parts(self._stack, settings, self.body)
        self._told = Heard()
        for kind in SEEN:
            self.parts.bus.subscribe(kind, self._told.add)

    def start(self):
        build.start_parts(self._stack, self.parts)
        self.parts.voice.speech_output.warm_up()
        return self

    def close(self):
        self._stack.close()

    def __enter__(self):
        return self.start()

    def __exit__(self, *_):
        self.close()

    @property
    def events(self):
        return self._told.messages

    def forget(self):
        """Stop everything, and note down anew.

        What was said in the room is understood first: its answer would else be spoken over what
        the next test says, which the listener then takes for the robot's own voice.
        """
        if self.room.played:
            self.room.play(silence(QUIET_S))
            self.room.played = False
        assert self.parts.listener.transcriber.wait_idle(HUNG_S)
        self.parts.conversation.submit(Reset())
        assert self.parts.conversation.wait_idle(HUNG_S)
        self.answer()
        self.events.clear()

    def of(self, kind):
        return [event for event in list(self.events) if isinstance(event, kind)]

    def wait_for(self, kind, wanted=lambda event: True):
        """The first event of this kind that is wanted; fails loudly if none comes."""
        return self._told.wait_for(lambda event: isinstance(event, kind) and wanted(event))

    def wait_until(self, true):
        """Until this is true of what it told."""
        self._told.wait_until(true)

    def calls(self):
        """The skills that were called, with their arguments."""
        return [(one.skill, dict(one.arguments)) for one in self.of(ToolCalled)]

    def answer(self):
        """What was said aloud since this was last asked, at 16 kHz."""
        sound = whole_wav(self._answers)
        new = sound[self._heard :]
        self._heard = sound.size
        return new


def says(language: str, name: str, text: str, pool: VoicePool):
    """Spoken by a voice by its name, at 16 kHz."""
    chunks = speak(voice(language, name), text, pool)
    return np.concatenate([resampled(one.samples, one.rate_hz, RATE_HZ) for one in chunks])
