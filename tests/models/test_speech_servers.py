"""Home Assistant's own servers in other processes, wyoming-faster-whisper and wyoming-piper, and a
robot that hears and speaks by them; and one that hangs, which costs no stop word.
"""

import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, silence
from ports import free_port
from speech_server import wyoming_speech
from voice_rig import SLOWLY, VoiceRig
from waiting import wait_until

from edgevox.core.agent_events import GoalChanged, SafetyPreempted
from edgevox.core.cancel import CancelToken
from edgevox.core.events import Responded
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import OddAnswer
from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.remote.hearing import open_hearing_server
from edgevox.voice.remote.speaking import open_speaking_server
from edgevox.voice.wav import resampled

pytestmark = pytest.mark.long

VOICE = "en_US-joe-medium"
LONGEST_S = 60.0
"""The longest that the settings allow."""


@contextmanager
def serving(module: str, *options: object) -> Iterator[str]:
    """The address of a server that this module starts."""
    port = free_port()
    url = f"tcp://127.0.0.1:{port}"
    command = [sys.executable, "-m", module, "--uri", url, "--local-files-only"]
    process = subprocess.Popen(
        [*command, *map(str, options)], env=os.environ | {"HF_HUB_OFFLINE": "1"}
    )

    def listens() -> bool:
        assert process.poll() is None, "the server ended"
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", port)) == 0

    try:
        wait_until(listens)
        yield url
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope="module")
def hears(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    model = ("--model", locate("whisper-tiny.en"), "--stt-library", "faster-whisper")
    how = ("--beam-size", 1, "--cpu-threads", 2)
    folder = ("--data-dir", tmp_path_factory.mktemp("hears"))
    with serving("wyoming_faster_whisper", *model, *how, *folder) as url:
        yield url


@pytest.fixture(scope="module")
def speaks(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    voices = Path(locate("piper-en_US-joe-medium")).parent
    folders = ("--data-dir", voices, "--download-dir", tmp_path_factory.mktemp("speaks"))
    with serving("wyoming_piper", "--voice", VOICE, *folders) as url:
        yield url


def test_what_one_says_the_other_hears(hears: str, speaks: str) -> None:
    speaking = open_speaking_server(Address(speaks, timeout_s=HUNG_S), VOICE)
    chunks = list(speaking.speak("Go to the kitchen.", "en", CancelToken()))
    speaking.close()
    rate_hz = chunks[0].rate_hz
    sound = resampled(np.concatenate([one.samples for one in chunks]), rate_hz, RATE_HZ)
    around = np.concatenate([silence(0.5), sound, silence(0.5)])

    hearing = open_hearing_server(Address(hears, timeout_s=HUNG_S))
    # The server's voice is never twice the same, and its Whisper may take "Go" for another word.
    said = hearing.transcribe(around, "en", "", CancelToken()).text
    assert said.endswith("the kitchen.")
    assert hearing.transcribe(silence(1.0), "en", "", CancelToken()).text == ""
    hearing.close()


def test_a_voice_that_the_server_lists_and_has_not_says_what_to_set(speaks: str) -> None:
    speaking = open_speaking_server(Address(speaks, timeout_s=HUNG_S, setting="tts_endpoint"))
    with pytest.raises(OddAnswer, match="tts_endpoint_voice"):
        list(speaking.speak("Hello.", "en", CancelToken()))
    speaking.close()


def spoken(text: str) -> np.ndarray:
    return np.concatenate([silence(0.5), loud(says_espeak(text, "en-us"), 0.1), silence(1.5)])


def test_a_robot_hears_and_speaks_by_servers(
    hears: str, speaks: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    endpoints = {
        "stt_endpoint": hears,
        "stt_endpoint_timeout": LONGEST_S,
        "tts_endpoint": speaks,
        "tts_endpoint_timeout": LONGEST_S,
        "tts_endpoint_voice": VOICE,
    }
    answers = tmp_path / "answers.wav"
    monkeypatch.setattr("edgevox.voice.remote.wyoming.LOOK_S", LONGEST_S)  # however busy they are
    with VoiceRig(monkeypatch, answers, robot="robot-apartment", **endpoints) as rig:
        rig.room.play(spoken("go to the kitchen"))
        rig.wait_for(GoalChanged, lambda one: one.status == "succeeded")
        assert rig.parts.conversation.wait_idle(HUNG_S)
        assert rig.answer().any()
        told = {one.name: one.values for one in rig.parts.components.statuses()}
        assert rig.calls() == [("navigate_to", {"room": "kitchen"})]
    for part in ("stt", "tts"):
        assert (told[part]["server_up"], told[part]["fallbacks"]) == (True, 0), part


@pytest.mark.parametrize("spotter", [True, False], ids=["by its sound", "by its words"])
def test_a_stop_word_halts_a_drive_while_the_server_that_hears_hangs(
    spotter: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    over = threading.Event()
    with wyoming_speech(lambda *_: over.wait(HUNG_S)) as server:
        hangs = {"stt_endpoint": server.address("stt").url, "stt_endpoint_timeout": LONGEST_S}
        more = {"stop_spotter": spotter, "speed": SLOWLY, "voice": "espeak-en", **hangs}
        with VoiceRig(monkeypatch, tmp_path / "said.wav", robot="robot-apartment", **more) as rig:
            rig.parts.conversation.start_goal("navigate_to", {"room": "bedroom"})
            rig.wait_for(GoalChanged, lambda one: one.status == "running")
            rig.room.play(spoken("stop"))
            assert rig.wait_for(SafetyPreempted).stopped
            rig.wait_for(Responded, lambda one: one.text.startswith("Stopped"))
            assert rig.parts.voice.hearing.shared.health.fallbacks == 0, "the server still hangs"
        over.set()
