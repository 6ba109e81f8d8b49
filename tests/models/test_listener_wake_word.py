"""openWakeWord's wake word, on synthesised speech: heard when said, and not in three minutes of
anything else; the benchmark `wake_words` takes hours.

The minutes: half of what espeak-ng reads of 14 English lines (some with near misses such as "hey
Marvin") and 24 in six other languages at two speeds, and Piper's joe of the English ones; hiss,
rumble, hum, bursts, a melody and clicks. All of it is made by `listener_rig`.
"""

import itertools

import numpy as np
import pytest
from listener_rig import (
    RATE_HZ,
    chatter,
    heard_at,
    in_a_room,
    loud,
    noises,
    says_espeak,
    says_piper,
    silence,
)

from edgevox.core.errors import InvalidValue
from edgevox.models import locate
from edgevox.voice.wake.wakeword import WakeWord, phrases

PHRASES = ("alexa", "hey jarvis", "hey mycroft", "hey rhasspy", "okay nabu")
THREE_MINUTES_S = 180


@pytest.fixture(scope="module")
def hey_jarvis():
    wakeword = WakeWord("hey jarvis", locate("wake-words"))
    yield wakeword
    wakeword.close()


@pytest.mark.parametrize("level", [0.2, 0.02])
@pytest.mark.parametrize("text", ["hey jarvis", "hey jarvis, go to the kitchen"])
def test_it_is_heard_once_when_it_is_said(hey_jarvis, level, text):
    assert len(heard_at(hey_jarvis, in_a_room(loud(says_piper(text), level)))) == 1


def test_even_a_robots_voice_can_say_it(hey_jarvis):
    assert len(heard_at(hey_jarvis, in_a_room(loud(says_espeak("hey jarvis"), 0.1)))) == 1


def test_it_is_heard_within_a_quarter_of_a_second_of_its_end(hey_jarvis):
    said = says_piper("hey jarvis")
    last = np.flatnonzero(np.abs(said) > 500)[-1]

    (at_s,) = heard_at(hey_jarvis, in_a_room(said))

    assert at_s - (1.5 + last / RATE_HZ) < 0.25


def test_it_is_heard_in_the_noise_of_a_room(hey_jarvis):
    said = in_a_room(loud(says_piper("hey jarvis"), 0.1))
    noise = loud(noises(said.size / RATE_HZ)["hiss"], 0.01)[: said.size]

    assert len(heard_at(hey_jarvis, said[: noise.size] + noise)) == 1


@pytest.mark.long
def test_sleeping_in_silence_loses_nothing_that_it_hears_awake():
    folder = locate("wake-words")
    always = WakeWord("hey jarvis", folder, always_awake=True)
    sleeper = WakeWord("hey jarvis", folder)
    texts = ("hey jarvis", "Hey Jarvis! Stop.", "hey jarvis? what is your battery level")
    levels = itertools.cycle((0.1, 0.02))
    calls = [
        in_a_room(loud(voice(text), next(levels)))
        for voice in (says_piper, says_espeak)
        for text in texts
    ]

    awake = sum(len(heard_at(always, call)) for call in calls)

    assert awake == len(calls)
    assert sum(len(heard_at(sleeper, call)) for call in calls) == awake


@pytest.mark.long
def test_it_is_not_heard_in_three_minutes_of_other_speech_and_noise(hey_jarvis):
    sounds = [*itertools.islice(chatter(), None, None, 2), *noises(10.0).values()]
    seconds = sum(sound.size / RATE_HZ + 0.3 for sound in sounds)

    assert seconds >= THREE_MINUTES_S
    assert heard_at(hey_jarvis, np.concatenate([np.append(s, silence(0.3)) for s in sounds])) == []


@pytest.mark.parametrize(
    ("written", "phrase"),
    [*zip(PHRASES, PHRASES, strict=True), ("Okay Nabu", "okay nabu"), ("okay_nabu", "okay nabu")],
)
def test_every_phrase_loads_however_it_is_written(written, phrase):
    wakeword = WakeWord(written, locate("wake-words"))
    assert wakeword.phrase == phrase
    wakeword.close()


def test_an_unknown_phrase_is_refused_with_those_that_are_known():
    with pytest.raises(InvalidValue, match="wakeword: got 'hey you', expected one of alexa, hey j"):
        WakeWord("hey you", locate("wake-words"))

    assert tuple(phrases(locate("wake-words"))) == PHRASES
