"""microWakeWord's wake words, on synthesised speech: heard when said, and not in five minutes of
anything else, as `test_listener_wake_word` has it for openWakeWord's.
"""

import json

import numpy as np
import pytest
from listener_rig import RATE_HZ, chatter, heard_at, in_a_room, loud, noises, says_piper, silence

from edgevox.core.errors import InvalidValue
from edgevox.models import locate
from edgevox.voice.wake import micro
from edgevox.voice.wake.micro import MicroWakeWord, open_network

PHRASES = ("alexa", "hey jarvis", "hey mycroft", "okay nabu")


def described(phrase):
    return locate("micro-wake-words") / f"{phrase.replace(' ', '_')}.json"


@pytest.fixture(scope="module")
def hey_jarvis():
    wakeword = MicroWakeWord(described("hey jarvis"))
    yield wakeword
    wakeword.close()


@pytest.mark.parametrize("level", [0.2, 0.02])
@pytest.mark.parametrize("text", ["hey jarvis", "hey jarvis, go to the kitchen"])
def test_it_is_heard_once_when_it_is_said(hey_jarvis, level, text):
    assert len(heard_at(hey_jarvis, in_a_room(loud(says_piper(text), level)))) == 1


def test_it_is_heard_within_a_quarter_of_a_second_of_its_end(hey_jarvis):
    said = says_piper("hey jarvis")
    last = np.flatnonzero(np.abs(said) > 500)[-1]

    (at_s,) = heard_at(hey_jarvis, in_a_room(said))

    assert at_s - (1.5 + last / RATE_HZ) < 0.25


@pytest.mark.long
def test_it_is_not_heard_in_five_minutes_of_other_speech_and_noise(hey_jarvis):
    sounds = [*chatter(), *noises(10.0).values()]

    assert heard_at(hey_jarvis, np.concatenate([np.append(s, silence(0.3)) for s in sounds])) == []


@pytest.mark.parametrize("phrase", PHRASES)
def test_every_phrase_loads_and_hears_nothing_in_silence(phrase):
    wakeword = open_network(locate("micro-wake-words"), phrase)

    assert wakeword.phrase == phrase
    assert heard_at(wakeword, silence(3.0)) == []
    wakeword.close()


def test_a_likelihood_that_was_chosen_for_a_phrase_counts_instead_of_the_networks(monkeypatch):
    monkeypatch.setattr(micro, "CUTOFFS", {"hey jarvis": 1.0})
    wakeword = open_network(locate("micro-wake-words"), "hey jarvis")

    assert heard_at(wakeword, in_a_room(says_piper("hey jarvis"))) == []
    wakeword.close()


@pytest.mark.long
def test_alexa_is_heard_and_is_not_in_five_minutes_of_other_speech():
    wakeword = open_network(locate("micro-wake-words"), "alexa")
    others = np.concatenate([np.append(sound, silence(0.3)) for sound in chatter()])

    assert len(heard_at(wakeword, in_a_room(says_piper("alexa")))) == 1
    assert heard_at(wakeword, others) == []
    wakeword.close()


def test_a_network_that_somebody_trained_is_taken_from_where_it_lies(tmp_path):
    network = described("okay nabu")
    said = json.loads(network.read_text("utf-8")) | {
        "wake_word": "Hello  Robot",
        "model": "o.tflite",
    }
    (tmp_path / "own.json").write_text(json.dumps(said), "utf-8")
    (tmp_path / "o.tflite").write_bytes(network.with_suffix(".tflite").read_bytes())

    wakeword = MicroWakeWord(tmp_path / "own.json")

    assert wakeword.phrase == "hello robot"
    wakeword.close()


MICRO = {"probability_cutoff": 0.9, "sliding_window_size": 5}


@pytest.mark.parametrize(
    ("description", "weights", "reason"),
    [
        ("{", b"", "a file in JSON"),
        ("[1]", b"", "file"),
        ('{"model": "o.tflite"}', b"", "wake_word"),
        ({"wake_word": "x", "model": "../o.tflite", "micro": MICRO}, b"", "model"),
        ({"wake_word": "x", "model": "o.tflite", "micro": {}}, b"", "probability_cutoff"),
        ({"wake_word": "x", "model": "gone.tflite", "micro": MICRO}, b"", "can be read"),
        ({"wake_word": "x", "model": "o.tflite", "micro": MICRO}, b"not one", "TensorFlow"),
    ],
)
def test_files_that_are_no_network_are_refused(tmp_path, description, weights, reason):
    text = description if isinstance(description, str) else json.dumps(description)
    (tmp_path / "own.json").write_text(text, "utf-8")
    (tmp_path / "o.tflite").write_bytes(weights)

    with pytest.raises(InvalidValue, match=reason):
        MicroWakeWord(tmp_path / "own.json")


def test_after_a_reset_it_is_heard_again_at_once(hey_jarvis):
    said = in_a_room(loud(says_piper("hey jarvis"), 0.2))[RATE_HZ:]
    (at_s,) = heard_at(hey_jarvis, said)
    until_then = said[: round((at_s + 0.1) * RATE_HZ)]

    for _ in range(2):  # sooner than it would be heard again in one stretch of sound
        assert len(heard_at(hey_jarvis, until_then)) == 1
