"""The voice over ROS 2: another node is the robot's microphone, and one is its loudspeaker."""

import json
import re
import threading

import numpy as np
import phrases
import pytest
from agent_process import READY, Agent
from guards import HUNG_S
from interop_rig import hear, tell
from peer import SENSOR, STATE
from std_msgs.msg import Float32

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.tts.espeak import open_espeak
from edgevox.voice.wav import resampled
from edgevox_msgs.msg import AudioData

pytestmark = pytest.mark.long

BLOCK_S = 0.02
LOUD = 2 / 3


def says(text):
    """Spoken by espeak-ng, at 16 kHz, with quiet before and after it."""
    chunk = open_espeak().speak(text, "en-us", CancelToken())
    sound = resampled(chunk.samples, chunk.rate_hz, RATE_HZ) * LOUD
    return np.concatenate([quiet(0.5), sound.astype(np.int16)])


def quiet(seconds):
    noise = np.random.default_rng(7).normal(0, 10, int(seconds * RATE_HZ))
    return noise.astype(np.int16)


class Microphone:
    """A node that publishes all that it hears: what it is given, and quiet."""

    def __init__(self, peer):
        self._publish = tell(peer, AudioData, peer.name("audio_in"), SENSOR)
        self._left = quiet(0.0)
        self._lock, self._closing = threading.Lock(), threading.Event()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="microphone")
        self._thread.start()

    def hears(self, sound):
        """Hear this, and wait until all of it is published."""
        with self._lock:
            self._left = sound
            self._over.clear()
        assert self._over.wait(HUNG_S)

    def close(self):
        self._closing.set()
        self._thread.join()

    def _work(self):
        size = int(BLOCK_S * RATE_HZ)
        while not self._closing.wait(BLOCK_S):
            with self._lock:
                block, self._left = self._left[:size], self._left[size:]
                if not block.size:
                    self._over.set()
            whole = np.concatenate([block, quiet(BLOCK_S)[block.size :]])
            self._publish(AudioData(data=whole.astype("<i2").tobytes()))


@pytest.fixture
def voiced(domain, peer):
    """Starts an agent that hears and speaks over ROS 2; gives it, a peer and the microphone."""
    started = []

    def start(*arguments):
        agent = Agent(
            *("robot-apartment", "--ros2", "--audio-in", "ros2", "--audio-out", "ros2"),
            *("--llm", "none", *arguments),
            domain=domain,
        )
        started.append(agent)
        agent.wait_for_line(READY)
        other = peer()
        started.append(Microphone(other))
        return agent, other, started[-1]

    yield start
    for one in reversed(started):
        one.close() if isinstance(one, Microphone) else one.terminate()


def test_what_a_microphone_node_hears_is_done_and_answered_on_a_speaker_node(voiced):
    _, peer, microphone = voiced()
    transcription, response = peer.listen("transcription"), peer.listen("response")
    state, metrics = peer.listen("state", STATE), peer.listen("metrics")
    robot = peer.listen("robot_state", STATE)
    level = hear(peer, Float32, peer.name("audio_level"), SENSOR)
    speech = hear(peer, AudioData, peer.name("audio_out"))

    microphone.hears(says("go to the kitchen"))

    assert "kitchen" in transcription.wait_for(lambda _: True)
    assert response.wait_for(lambda _: True) == phrases.begins("navigate_to", room="kitchen")
    robot.wait_for(lambda m: json.loads(m)["velocity"]["linear"] > 0.05)
    measured = json.loads(metrics.wait_for(lambda _: True))
    assert 0.0 < measured["stt"] < measured["ttfs"] < measured["total"]
    assert measured["tts"] > 0.0
    state.wait_for(lambda m: m == "listening", since=len(state.messages) - 1)
    turn = state.messages[state.messages.index("transcribing") :]
    assert turn[:4] == ["transcribing", "thinking", "speaking", "listening"]
    level.wait_for_more(10)
    assert all(0.0 <= one.data <= 1.0 for one in level.messages)
    assert max(one.data for one in level.messages) > 0.02
    # Piper draws how it speaks; where the machine is slow it has said by now that it arrived.
    assert "kitchen" in heard_of(speech)


def test_what_is_heard_is_under_the_policy_of_voice(voiced, tmp_path):
    policy = tmp_path / "policy.yaml"
    policy.write_text("rules: {voice: {navigate_to: deny}}")
    _, peer, microphone = voiced("--policy", str(policy))
    events, response = peer.listen("agent_event"), peer.listen("response")

    microphone.hears(says("go to the kitchen"))

    told = json.loads(events.wait_for(lambda m: '"rejected"' in m))
    assert (told["way"], told["skill"], told["code"]) == ("voice", "navigate_to", "policy_denied")
    assert response.wait_for(lambda _: True) == phrases.refused("policy_denied")
    microphone.hears(says("where are you"))
    assert response.wait_for(lambda m: "I am in" in m)


def heard_of(speech):
    """What Whisper understands of what came for the loudspeaker."""
    sound = np.frombuffer(b"".join(bytes(one.data) for one in speech.messages), "<i2")
    padded = np.concatenate([quiet(0.3), sound.astype(np.int16), quiet(0.3)])
    words = Whisper(lambda _: locate("whisper-tiny.en")).transcribe(padded, "en").text
    return re.findall(r"[a-z]+", words.lower())


def test_with_a_wake_word_it_obeys_who_says_it_and_hears_nothing_while_muted(voiced):
    _, peer, microphone = voiced("--wakeword", "alexa")
    transcription, wakeword = peer.listen("transcription"), peer.listen("wakeword")
    info = peer.listen("info")
    level = hear(peer, Float32, peer.name("audio_level"), SENSOR)
    level.wait_for_more(5)

    peer.send("command", "mute")
    peer.send("command", "list_voices")  # the two are taken in this order
    info.wait_for(lambda _: True)
    muted_from = len(level.messages)
    microphone.hears(np.concatenate([says("alexa, where are you"), quiet(1.0)]))
    levels_while_muted = level.messages[muted_from + 1 :]  # one was on its way
    peer.send("command", "unmute")
    level.wait_for(lambda _: True, since=muted_from + 1)
    unmuted = [len(transcription.messages), len(wakeword.messages)]
    microphone.hears(says("alexa, where are you"))

    assert "where are you" in transcription.wait_for(lambda _: True).lower()
    assert wakeword.messages == ["alexa"]
    assert "alexa" not in transcription.messages[0].lower()
    assert levels_while_muted == []
    assert unmuted == [0, 0]
