"""Voice prints: who is known, who is a guest, what is kept of a person and what is not."""

import stat

import numpy as np
import pytest
from voice_script import Stt
from waiting import Heard as Told

from edgevox.core.clock import SystemClock
from edgevox.core.commands import Heard, Way
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.voice.transcriber import Transcriber, TranscriptionJob
from edgevox.voice.voiceprint import (
    ALIKE,
    JUST_NOW_S,
    MOST_NAME,
    SENTENCES,
    KnownVoices,
    VoiceEncoder,
    VoicePrints,
)

ANNA, BEN = np.eye(256, dtype=np.float32)[:2]
SOUND = np.zeros(16_000, np.int16)


def like(person, likeness):
    """A vector of length 1 that is as like a person as that."""
    other = np.eye(256, dtype=np.float32)[9]
    return (likeness * person + np.sqrt(1 - likeness**2) * other).astype(np.float32)


class Voices:
    """In place of the network: what it makes of the next utterances; None is too short."""

    def __init__(self, *vectors):
        self._vectors = iter(vectors)

    def of(self, _):
        vector = next(self._vectors)
        if isinstance(vector, Exception):
            raise vector
        return vector


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "voiceprints"


@pytest.fixture
def prints(folder):
    one = VoicePrints(folder)
    one.keep("Anna", [ANNA] * SENTENCES)
    one.keep("ben", [BEN] * SENTENCES)
    return one


def said_by(prints, *vectors, every_s=1.0):
    known = KnownVoices(Voices(*vectors), prints)
    return [known.who(SOUND, number * every_s) for number in range(len(vectors))]


def test_the_likest_person_is_known_and_who_is_like_none_is_a_guest(prints):
    heard = [like(ANNA, ALIKE + 0.01), like(BEN, 0.95), like(ANNA, ALIKE - 0.01)]
    assert said_by(prints, *heard) == ["anna", "ben", ""]


def test_what_is_too_short_is_of_the_person_who_has_just_spoken(prints):
    assert said_by(prints, None, ANNA, None) == ["", "anna", "anna"]
    assert said_by(prints, ANNA, like(BEN, 0.1), None) == ["anna", "", ""]
    assert said_by(prints, ANNA, None, every_s=JUST_NOW_S + 1.0) == ["anna", ""]


def test_a_person_who_is_forgotten_is_a_guest_at_once(prints, folder):
    known = KnownVoices(Voices(ANNA, None, ANNA), prints)
    assert known.who(SOUND, 0.0) == "anna"
    assert VoicePrints(folder).forget("ANNA")
    assert [known.who(SOUND, 1.0), known.who(SOUND, 2.0)] == ["", ""]
    assert not prints.forget("anna")
    assert list(prints.read()) == ["ben"]


def test_a_voice_that_cannot_be_judged_is_a_guests(prints, caplog):
    known = KnownVoices(Voices(EdgeVoxError("no weights"), ANNA), prints)
    assert [known.who(SOUND, 0.0), known.who(SOUND, 1.0)] == ["", "anna"]
    assert known.failed == 1
    assert "voice_unjudged" in caplog.text


def test_with_nobody_enrolled_all_are_guests_and_no_voice_is_looked_at(folder):
    assert said_by(VoicePrints(folder), EdgeVoxError("not asked")) == [""]


def test_only_its_owner_may_read_a_print_and_it_holds_no_sound(prints, folder):
    files = list(folder.iterdir())
    assert [one.name for one in sorted(files)] == ["anna.json", "ben.json"]
    assert {stat.S_IMODE(one.stat().st_mode) for one in files} == {0o600}
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_a_damaged_print_is_put_aside_and_the_others_count(prints, folder):
    (folder / "anna.json").write_text("[1, 2]")
    assert list(prints.read()) == ["ben"]
    assert "anna.json was damaged" in prints.fault


def test_sentences_of_two_people_are_no_voice_print(prints):
    with pytest.raises(InvalidValue, match="3 sentences of one voice"):
        prints.keep("carl", [ANNA, ANNA, BEN])
    with pytest.raises(InvalidValue, match="3 sentences of one voice"):
        prints.keep("carl", [ANNA] * (SENTENCES - 1))


@pytest.mark.parametrize("name", ["", " ", "../anna", "a/b", ".anna", "x" * (MOST_NAME + 1)])
def test_a_name_is_no_path(prints, name):
    with pytest.raises(InvalidValue, match="letters, digits and hyphens"):
        prints.keep(name, [ANNA] * SENTENCES)


def test_weights_that_are_none_say_which_file(tmp_path):
    file = tmp_path / "pretrained.pt"
    file.write_bytes(b"x")
    noise = np.random.default_rng(1).normal(0, 3000, 32_000).astype(np.int16)
    with pytest.raises(EdgeVoxError, match=r"pretrained\.pt"):
        VoiceEncoder(file).of(noise)


def test_a_shorter_utterance_and_silence_tell_nothing(tmp_path):
    encoder = VoiceEncoder(tmp_path / "not looked at")
    assert encoder.of(np.full(8_000, 900, np.int16)) is None
    assert encoder.of(np.zeros(32_000, np.int16)) is None


@pytest.mark.parametrize(
    ("known", "way"),
    [(None, Way.VOICE), (lambda *_: True, Way.VOICE), (lambda *_: False, Way.VOICE_GUEST)],
)
def test_the_words_of_a_guest_come_by_a_way_of_their_own(known, way):
    told = Told()
    one = Transcriber(
        Stt("go to the kitchen"),
        told.add,
        language=lambda: "en",
        is_stop=lambda _: False,
        clock=SystemClock(),
        known=known,
    )
    one.start()
    try:
        assert one.take(TranscriptionJob(SOUND, 0.0, 1.0))
        assert one.wait_idle(60)
    finally:
        one.close()
    (heard,) = [message for message in told.messages if isinstance(message, Heard)]
    assert (heard.text, heard.way) == ("go to the kitchen", way)
