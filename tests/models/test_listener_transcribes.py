"""What the listener makes of real sound: voice activity, words, and the silence in between."""

import gc
import threading
import time

import numpy as np
import pytest
from listener_rig import loud, noises, says_espeak, says_piper, silence
from support.clock import HeldClock
from support.recordings import InMemory

from edgevox.core.bus import Bus
from edgevox.core.commands import Heard
from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.listener import Listener
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.vad import open_vad
from edgevox.voice.wake.wakeword import WakeWord

PROMPT = (
    "Go to x 2.5, y minus 1. Turn left 90 degrees. "
    "Drive forward half a meter, then back 30 centimeters. Go to the kitchen. Stop! Halt!"
)


@pytest.fixture(scope="module")
def whisper():
    stt = Whisper(lambda _: locate("whisper-tiny.en"), prompt_of=lambda _: PROMPT, threads=2)
    stt.warm_up("en")
    yield stt
    stt.close()


def listen(stt, sound, **more):
    """All that was heard in a sound."""
    said = []
    listener = Listener(
        InMemory(sound, clock=HeldClock()),
        open_vad(),
        stt,
        submit=said.append,
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.0,
        lossless=True,
        **more,
    )
    listener.start()
    assert listener.wait_over(600.0)
    listener.close()
    return [command for command in said if isinstance(command, Heard)]


def plain(text):
    return "".join(c for c in text.lower() if c.isalnum() or c in " .-").strip(" .")


def test_commands_are_understood_with_noise_around_them(whisper):
    commands = (
        "go to the kitchen",
        "turn left ninety degrees",
        "drive forward half a meter",
        "stop",
    )
    pieces = [silence(1.0)]
    for command in commands:
        pieces += [loud(says_piper(command), 0.08), silence(1.2)]
    sound = np.concatenate(pieces)
    hiss = loud(noises(sound.size / RATE_HZ)["hiss"], 0.003)

    heard = listen(whisper, sound[: hiss.size] + hiss[: sound.size])

    assert [plain(h.text) for h in heard] == [c.replace("ninety", "90") for c in commands]


def test_coordinates_are_written_as_the_prompt_writes_them(whisper):
    text = whisper.transcribe(says_piper("go to x two point five y minus one"), "en").text

    assert plain(text) == "go to x 2.5 y minus 1"


def test_an_utterance_ends_with_its_last_voiced_sample(whisper):
    said = says_espeak("go to the bedroom")
    last_s = 1.0 + np.flatnonzero(np.abs(said) > 500)[-1] / RATE_HZ

    (heard,) = listen(whisper, np.concatenate([silence(1.0), said, silence(1.5)]))

    assert heard.ended_s == pytest.approx(last_s, abs=0.12)


def test_noise_is_no_words(whisper):
    for name, noise in noises(4.0).items():
        assert whisper.transcribe(noise, "en").text == "", name
        assert [h.text for h in listen(whisper, noise) if h.text] == [], name


def test_with_a_wake_word_its_command_and_any_stop_are_understood(whisper):
    wakeword = WakeWord("hey jarvis", locate("wake-words"))
    sound = [silence(1.0)]
    for said in (
        "I went to the kitchen yesterday, and then I had a long talk with my brother",
        "Hey Jarvis, go to the bedroom.",
        "turn left",
        "stop",
    ):
        sound += [loud(says_piper(said), 0.1), silence(1.2)]

    heard = listen(
        whisper,
        np.concatenate(sound),
        wakeword=wakeword,
        is_stop=lambda text: "stop" in text.lower(),
    )

    wakeword.close()
    assert [plain(h.text) for h in heard] == ["go to the bedroom", "stop"]


def test_listening_to_silence_costs_a_fraction_of_listening_awake(whisper):
    """How much of a core that is depends on the machine: it is a figure of the benchmarks."""

    def computed_s(**more):
        wakeword = WakeWord("hey jarvis", locate("wake-words"), **more)
        before_s = time.process_time()
        assert listen(whisper, silence(8.0), wakeword=wakeword) == []
        wakeword.close()
        return time.process_time() - before_s

    asleep, awake = computed_s(), computed_s(always_awake=True)
    assert asleep < awake / 3


@pytest.mark.long
def test_ten_minutes_leave_no_thread_and_no_memory_behind(whisper):
    quiet = np.concatenate([silence(59.0), says_piper("stop")])
    listen(whisper, quiet)
    gc.collect()
    threads, resident = threading.active_count(), resident_kib()

    for _ in range(10):
        listen(whisper, quiet)

    gc.collect()
    assert threading.active_count() == threads
    assert resident_kib() - resident < 20_000


def resident_kib():
    with open("/proc/self/status", encoding="utf-8") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
