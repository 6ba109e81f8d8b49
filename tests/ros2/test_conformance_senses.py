"""The rows of the contract that need microphone, camera and model, each with a real source.

One agent hears a recording of "hey jarvis" and a question, spoken by Piper, looks at its table, and
is asked something that only a model can answer. It starts to hear when all is loaded; the peer is
there before.
"""

import json

import numpy as np
import pytest
from agent_process import Agent
from bodies_rig import CONTRACT, full
from interop_rig import hear
from peer import SENSOR, Peer
from piper import PiperVoice
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Float32, String
from steady_piper import STEADY
from support.recordings import write_wav

from edgevox.models import locate

PUBLISHED = CONTRACT["published"]
RATE_HZ = 22050
QUIET_S = 900
"""The agent ends with the recording: longer than the tests take on any machine."""


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A second of quiet, "hey jarvis", a question, and quiet for longer than the tests take."""
    voice = PiperVoice.load(locate("piper-en_US-joe-medium"))
    pause = np.zeros(RATE_HZ, np.int16)
    parts = [pause]
    for text in ("Hey Jarvis.", "What do you see?"):
        parts += [c.audio_int16_array for c in voice.synthesize(text, STEADY)]
    path = tmp_path_factory.mktemp("sound") / "asked.wav"
    return write_wav(path, *parts, *(QUIET_S * [pause]), rate_hz=RATE_HZ)


@pytest.fixture(scope="module")
def heard(domain, recording):
    """What a peer heard on each of these topics, its pictures since the question was answered."""
    agent = Agent(
        "robot-panda",
        "--ros2",
        "--no-render",
        "--llm=smollm2-135m-instruct",
        "--wakeword=hey jarvis",
        f"--audio-in={recording}",
        "--audio-out=none",
        domain=domain,
    )
    try:
        agent.wait_for_line("ROS 2:")
        peer = Peer(domain)
        try:
            yield asked(agent, peer)
        finally:
            peer.close()
    finally:
        agent.terminate()


def asked(agent, peer):
    """Listen to all, wait until the question was answered, and ask what only a model answers."""
    heard = {
        "audio_level": hear(peer, Float32, full("audio_level"), SENSOR),
        "wakeword": hear(peer, String, full("wakeword")),
        "transcription": hear(peer, String, full("transcription")),
        "bot_sentence": hear(peer, String, full("bot_sentence")),
        "metrics": hear(peer, String, full("metrics")),
        "bot_token": hear(peer, String, full("bot_token"), SENSOR),
    }
    agent.wait_for_line("is ready")
    heard["wakeword"].wait_for(lambda _: True)
    heard["metrics"].wait_for(lambda _: True)
    # Pictures cost the more, the longer somebody looks.
    heard["image_raw"] = hear(peer, Image, full("image_raw"), SENSOR)
    heard["camera_info"] = hear(peer, CameraInfo, full("camera_info"), SENSOR)
    peer.send("text_input", "what is the capital of Norway?")
    heard["bot_token"].wait_for(lambda _: True)
    return heard


def test_the_level_of_the_sound_is_between_silence_and_full(heard):
    low, high = PUBLISHED["audio_level"]["range"]
    levels = [message.data for message in heard["audio_level"].messages]

    assert len(levels) > 10
    assert low <= min(levels) < 0.02
    assert 0.05 < max(levels) <= high


def test_the_wake_word_is_named_once(heard):
    assert [message.data for message in heard["wakeword"].messages] == ["hey jarvis"]


def test_what_was_asked_aloud_is_transcribed_and_answered(heard):
    spoken = heard["transcription"].messages[0].data
    answer = heard["bot_sentence"].messages[0].data

    assert spoken.casefold().strip(" .?!") == "what do you see"
    assert answer.startswith("I see")
    assert "the red cube" in answer


def test_the_times_of_a_spoken_turn_are_all_there(heard):
    measured = json.loads(heard["metrics"].messages[0].data)

    assert list(measured) == PUBLISHED["metrics"]["json"]
    assert measured["stt"] > 0
    assert measured["tts"] > 0
    assert 0 < measured["ttfs"] < 30


def test_a_model_is_heard_token_by_token(heard):
    tokens = [message.data for message in heard["bot_token"].messages]

    assert all(tokens)


def test_pictures_come_with_their_camera_while_all_that_goes_on(heard):
    image = heard["image_raw"]
    image.wait_for(lambda _: True, since=len(image.messages))
    picture = image.messages[-1]
    model = heard["camera_info"].wait_for(lambda m: m.header == picture.header)

    assert picture.encoding == CONTRACT["robot_interop"]["image_raw"]["encoding"]
    assert len(picture.data) == 3 * picture.width * picture.height
    assert (model.width, model.height) == (picture.width, picture.height)
