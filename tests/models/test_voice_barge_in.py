"""Barge-in in simulated time: a person speaks over the robot in a room that echoes.

A real listener (voice activity, echo gate), real speech output and voice (Piper); time passes only
while the loudspeaker plays, and each frame of it is heard before the next is played.
"""

import threading

import numpy as np
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak
from voice_engines import voice

from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.commands import Heard, Interrupt, SpokenOver
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, EndOfSound, Frame
from edgevox.voice.listener import Listener
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.sinks.paced import PacedSink
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.stt.speech_to_text import Transcript
from edgevox.voice.tts.voices import VoicePool
from edgevox.voice.vad import open_vad

ANSWER = "I am on my way through the long corridor to the bedroom, and I will tell you more there."
ECHO_DELAY_S = 0.06
PERSON_AT_S = 2.0


class Deaf:
    """Speech to text is not asked here."""

    def transcribe(self, samples, language):
        return Transcript("")

    def warm_up(self, language): ...

    def close(self): ...


class EchoingRoom:
    """Clock, loudspeaker and microphone: what is played comes back, later and weaker."""

    name = "room"
    rate_hz = RATE_HZ
    block_s = 0.02
    lead_s = 0.0

    def __init__(self, person, echo_db):
        self.person, self.echo = person, 10 ** (echo_db / 20)
        self.now_s, self.played_s, self.played = 0.0, 0.0, np.zeros(40 * RATE_HZ)
        self._heard_frames, self._passing, self.silent = 0, threading.Lock(), None
        self._frame, self._closed, self._changed = None, False, threading.Condition()

    # the clock, and what the loudspeaker waits with

    def now(self):
        return self.now_s

    def wait(self, token, seconds):
        with self._passing:
            self.now_s += seconds
            while (self._heard_frames + 1) * FRAME_SAMPLES / RATE_HZ <= self.now_s:
                self._hear(self._heard_frames)
                self._heard_frames += 1
        return token.cancelled

    def goes_on(self, token):
        """Its time passes while nothing is played."""

        def pass_time():
            while not self.wait(token, self.block_s):
                pass

        self.silent = threading.Thread(target=pass_time)
        self.silent.start()

    # the loudspeaker

    def write(self, samples, start_s):
        start = round(start_s * RATE_HZ)
        self.played[start : start + samples.size] = samples
        self.played_s = start_s + samples.size / RATE_HZ

    # the microphone

    def start(self): ...

    def read(self, timeout_s):
        with self._changed:
            self._frame = None
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._frame or self._closed, timeout_s)
            if self._closed:
                raise EndOfSound("room: over")
            return self._frame

    def close(self):
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def _hear(self, number):
        """One frame; returns when the listener asks for the next."""
        where = np.arange(number * FRAME_SAMPLES, (number + 1) * FRAME_SAMPLES)
        late = where - round(ECHO_DELAY_S * RATE_HZ)
        sound = np.where(late >= 0, self.played[late], 0.0) * self.echo
        at = where - round(PERSON_AT_S * RATE_HZ)
        inside = (at >= 0) & (at < self.person.size)
        sound[inside] += self.person[at[inside]]
        frame = Frame(sound.astype(np.int16), (number + 1) * FRAME_SAMPLES / RATE_HZ)
        with self._changed:
            self._frame = frame
            self._changed.notify_all()
            asked = self._changed.wait_for(lambda: self._frame is not frame, HUNG_S)
        assert asked, "the listener does not listen"


@pytest.fixture(scope="module")
def pool():
    return VoicePool()


@pytest.fixture
def speak_in(pool):
    """Speaks in a room until all is said, or somebody is heard; gives what was submitted."""

    def run(room):
        token, said = CancelToken(), []
        choice = voice("en", "en_US-joe-medium")
        sink = PacedSink(room, clock=room, wait=room.wait)
        speech_output = SpeechOutput(
            SentenceSynthesiser(lambda: [choice], pool, clock=room), sink, clock=room
        )

        def submit(command):
            match command:
                case SpokenOver():
                    said.append(room.now_s)
                    speech_output.hold()
                    room.goes_on(token)
                case Interrupt(reason=reason):
                    token.cancel(reason)
                case Heard(over=True):
                    token.cancel("spoken over")

        listener = Listener(
            room,
            open_vad(),
            Deaf(),
            submit=submit,
            bus=Bus(),
            language=lambda: "en",
            muted=lambda: False,
            audible=sink.audible,
            clock=room,
        )
        speech_output.start()
        listener.start()
        utterance = speech_output.begin(token, lambda: None)
        utterance.say(ANSWER)
        spoken = utterance.finish()
        if room.silent:
            room.silent.join(HUNG_S)
        listener.close()
        speech_output.close()
        sink.close()
        return spoken, said

    return run


@pytest.mark.parametrize(("echo_db", "level"), [(-12, 0.15), (-24, 0.08)])
def test_who_speaks_over_the_robot_silences_it_within_half_a_second(speak_in, echo_db, level):
    person = loud(says_espeak("no no no, wait a moment", "en-us"), level)
    voiced_s = PERSON_AT_S + np.flatnonzero(np.abs(person) > 300)[0] / RATE_HZ
    room = EchoingRoom(person, echo_db)

    spoken, interrupted_s = speak_in(room)

    assert spoken.cut
    assert voiced_s < room.played_s < voiced_s + 0.5
    assert room.played_s - interrupted_s[0] <= 0.1


def test_its_own_echo_does_not_silence_it(speak_in):
    room = EchoingRoom(np.zeros(0, np.int16), -12)

    spoken, interrupted_s = speak_in(room)

    assert spoken.text == ANSWER
    assert interrupted_s == []
    assert room.played_s > 3.0
