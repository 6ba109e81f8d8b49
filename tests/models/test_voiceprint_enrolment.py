"""People are told by their voice: enrolled from recordings as by the command, known, forgotten."""

import itertools

import numpy as np
import pytest
from guards import run_program
from listener_rig import says_espeak, says_piper, silence
from support.recordings import write_wav
from test_listen import LISTEN

from edgevox.models import locate
from edgevox.voice.voiceprint import ALIKE, ENCODER, KnownVoices, VoiceEncoder, VoicePrints

COMMAND = [*LISTEN[:-1], "voiceprint"]
SENTENCES = (
    "I would like you to come back here in ten minutes.",
    "Tell me what you can see on the table in the living room.",
    "Please go to the kitchen and look whether the window is open.",
)
ORDER = "Go to the bedroom and wait for me beside the door."


@pytest.fixture(scope="module")
def encoder():
    return VoiceEncoder(locate(ENCODER))


def recording(file, *said):
    pieces = itertools.chain.from_iterable((silence(1.2), one) for one in said)
    return str(write_wav(file, *pieces, silence(1.2)))


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))

    def run(*arguments):
        done = run_program([*COMMAND, *arguments])
        return done.returncode, done.stdout, done.stderr

    return run


def test_one_voice_is_like_itself_and_unlike_another(encoder):
    joe, other = encoder.of(says_piper(ORDER)), encoder.of(says_espeak(ORDER))
    for sentence in SENTENCES:
        assert joe @ encoder.of(says_piper(sentence)) > ALIKE > other @ joe
        assert np.isclose(np.linalg.norm(joe), 1.0)


def test_softer_speech_between_silences_is_of_the_same_voice(encoder):
    said = says_piper(ORDER)
    soft = np.concatenate([silence(1.0) // 10, said // 4, silence(2.0) // 10])
    assert encoder.of(said) @ encoder.of(soft) > ALIKE


def test_a_person_is_enrolled_known_and_forgotten(run, encoder, tmp_path):
    file = recording(tmp_path / "joe.wav", says_piper("No."), *map(says_piper, SENTENCES))

    code, told, errors = run("enrol", "Joe", "--audio-in", file)

    assert code == 0, errors
    assert "too short" in told
    assert "joe is enrolled" in told.lower()
    assert run("list")[1] == "joe\n"
    known = KnownVoices(encoder, VoicePrints(tmp_path / "edgevox" / "voiceprints"))
    assert known.who(says_piper(ORDER), 0.0) == "joe"
    assert known.who(says_espeak(ORDER), 1.0) == ""

    assert run("forget", "joe")[0] == 0
    assert known.who(says_piper(ORDER), 2.0) == ""
    assert run("list")[1] == ""
    assert run("forget", "joe")[0] == 1


def test_two_voices_are_not_enrolled_as_one_nor_too_few_sentences(run, tmp_path):
    both = recording(
        tmp_path / "both.wav", *map(says_piper, SENTENCES[:2]), says_espeak(SENTENCES[2])
    )
    code, _, errors = run("enrol", "joe", "--audio-in", both)
    assert (code, "of one voice" in errors) == (1, True)

    few = recording(tmp_path / "few.wav", says_piper(SENTENCES[0]))
    code, _, errors = run("enrol", "joe", "--audio-in", few)
    assert (code, "ended after 1 of 3 sentences" in errors) == (1, True)
    assert run("list")[1] == ""


def test_without_a_microphone_it_says_what_it_needs(run):
    code, _, errors = run("enrol", "joe", "--audio-in", "none")
    assert (code, "a microphone, a WAV file or a folder" in errors) == (1, True)
