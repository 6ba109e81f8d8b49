"""Sound on a topic that is not what it should be is noticed by its pace and its loudness."""

import numpy as np
import pytest

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.sources.pushed import WINDOW_S, FormCheck

RANDOM = np.random.default_rng(1)
TONE = (3000 * np.sin(np.arange(RATE_HZ * 2) / 8)).astype(np.int16)
SPEECH = TONE * (np.arange(TONE.size) % 4000 > 1500)


def judged(data: bytes, byte_rate: int, *, jitter_s: float = 0.0) -> str | None:
    """What is found of bytes that come at this pace, in messages of 40 ms, with a WiFi's jitter."""
    form, found, size = FormCheck(), None, byte_rate // 25 // 4 * 4
    for number in range(int(25 * (WINDOW_S + 1))):
        at = number * size % (len(data) - size)
        now_s = number / 25 + jitter_s * RANDOM.random()
        found = form.judge(np.frombuffer(data[at : at + size], "<i2"), now_s) or found
    return found


@pytest.mark.parametrize("sound", [SPEECH, 8 * SPEECH, np.zeros_like(TONE)], ids=["", "loud", "0"])
def test_nothing_is_wrong_with_sound_as_it_should_be(sound: np.ndarray) -> None:
    assert not judged(sound.astype("<i2").tobytes(), 2 * RATE_HZ, jitter_s=0.03)


@pytest.mark.parametrize(
    ("data", "byte_rate", "told"),
    [
        (SPEECH.repeat(3).tobytes(), 6 * RATE_HZ, "48000 samples a second; expected 16000 Hz"),
        (SPEECH.repeat(2).tobytes(), 4 * RATE_HZ, "32000 samples a second"),
        (SPEECH[::2].tobytes(), RATE_HZ, "8000 samples a second"),
        (SPEECH.astype(">i2").tobytes(), 2 * RATE_HZ, "noise at full scale"),
        (SPEECH.astype("<f4").tobytes(), 4 * RATE_HZ, "as of floats"),
        (RANDOM.bytes(64_000), 16_000, "noise at full scale"),
        (TONE.astype(">i2").tobytes(), 2 * RATE_HZ, "noise at full scale"),
    ],
    ids=["48 kHz", "stereo", "8 kHz", "big-endian with pauses", "floats", "MP3", "big-endian"],
)
def test_sound_of_another_form_is_named(data: bytes, byte_rate: int, told: str) -> None:
    assert told in (judged(data, byte_rate) or "")


def test_pieces_with_pauses_between_them_tell_nothing() -> None:
    form = FormCheck()
    assert [form.judge(TONE[:3200], 2.0 * number) for number in range(9)] == [None] * 9
