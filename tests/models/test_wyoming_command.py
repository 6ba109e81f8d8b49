"""`edgevox wyoming` as a person starts it, asked by the library of Home Assistant's protocol."""

import asyncio
import signal
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, says_piper, silence
from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.client import AsyncClient
from wyoming.info import Describe, Info
from wyoming.wake import Detect

from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import OddAnswer
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.remote.hearing import open_hearing_server
from edgevox.voice.remote.speaking import open_speaking_server
from edgevox.voice.wav import resampled

pytestmark = pytest.mark.long

FORM = {"rate": RATE_HZ, "width": 2, "channels": 1}
COMMAND = [sys.executable, "-m", "edgevox.apps.edgevox", "wyoming", "--port", "0"]


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with subprocess.Popen(
        [*COMMAND, "--wakeword", "hey jarvis"], stdout=subprocess.PIPE, text=True
    ) as process:
        line = process.stdout.readline()
        try:
            assert line.endswith(": transcribes, speaks and hears hey jarvis, stop\n"), line
            yield line.partition(": ")[0]
        finally:
            process.send_signal(signal.SIGTERM)
            code = process.wait(HUNG_S)
    assert code == 0


async def _ask(url: str, *events) -> list:
    """What comes back until the connection has told of the sound's end, or described itself."""
    got = []
    async with AsyncClient.from_uri(url) as client:
        for one in events:
            await client.write_event(one.event())
        while event := await asyncio.wait_for(client.read_event(), HUNG_S):
            got.append(event)
            if Info.is_type(event.type) or event.type == "not-detected":
                break
    return got


def test_it_tells_what_it_has(url: str) -> None:
    info = Info.from_event(asyncio.run(_ask(url, Describe()))[0])
    assert "en" in info.asr[0].models[0].languages
    assert any(one.languages == ["en"] for one in info.tts[0].voices)
    assert [one.name for one in info.wake[0].models] == ["hey jarvis", "stop"]


def test_what_it_says_it_hears(url: str) -> None:
    speaking = open_speaking_server(Address(url, timeout_s=HUNG_S))
    chunks = list(speaking.speak("Go to the kitchen.", "en", CancelToken()))
    speaking.close()
    rate_hz = chunks[0].rate_hz
    sound = resampled(np.concatenate([one.samples for one in chunks]), rate_hz, RATE_HZ)
    hearing = open_hearing_server(Address(url, timeout_s=HUNG_S))
    assert hearing.transcribe(sound, "en", "", CancelToken()).text == "Go to the kitchen."
    with pytest.raises(OddAnswer, match="language"):
        hearing.transcribe(sound, "xx", "", CancelToken())
    hearing.close()


def test_it_hears_the_wake_word_and_a_stop_word_once_each(url: str) -> None:
    pieces = [silence(1.5), says_piper("hey jarvis"), silence(1.5)]
    sound = np.concatenate([*pieces, loud(says_espeak("stop", "en-us"), 0.1), silence(1.0)])
    chunks = [
        AudioChunk(**FORM, audio=sound[at : at + 1024].tobytes())
        for at in range(0, sound.size, 1024)
    ]
    quiet = [AudioStart(**FORM), AudioChunk(**FORM, audio=silence(1.0).tobytes()), AudioStop()]
    got = asyncio.run(_ask(url, Detect(), AudioStart(**FORM), *chunks, AudioStop(), *quiet))
    assert [one.data.get("name") for one in got[:-1]] == ["hey jarvis", "stop"]


def test_a_port_that_another_has_is_an_error_in_one_line(url: str) -> None:
    port = url.rpartition(":")[2]
    done = subprocess.run([*COMMAND[:-1], port], capture_output=True, text=True, timeout=HUNG_S)
    assert done.returncode == 1
    assert "cannot listen" in done.stderr
    assert "Traceback" not in done.stderr
