"""Utterances that are kept: what lies in the folder, for whom, how much of it, and for how long."""

import errno
import json
import stat
import wave

import numpy as np
import pytest

from edgevox.core.commands import Hypothesis
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.voice.stt.kept import KeepingSpeechToText, KeptAudio
from edgevox.voice.stt.speech_to_text import Transcript

SOUND = np.arange(16000, dtype=np.int16)


def names(folder, suffix="wav"):
    return sorted(one.name for one in folder.glob(f"*.{suffix}"))


def test_an_utterance_is_a_wav_file_with_a_json_line_of_the_same_name(tmp_path):
    path = KeptAudio(tmp_path / "kept").keep(SOUND, {"text": "go to the kitchen"})

    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, 16000)
        assert file.readframes(99999) == SOUND.tobytes()
    (line,) = path.with_suffix(".json").read_text("utf-8").splitlines()
    assert json.loads(line)["text"] == "go to the kitchen"


def test_nobody_else_can_read_it(tmp_path):
    kept = KeptAudio(tmp_path / "kept")
    path = kept.keep(SOUND, {})

    assert stat.S_IMODE(kept.folder.stat().st_mode) == 0o700
    for file in (path, path.with_suffix(".json")):
        assert stat.S_IMODE(file.stat().st_mode) == 0o600


def test_of_too_many_the_oldest_are_deleted(tmp_path):
    kept = KeptAudio(tmp_path, most_utterances=3)
    paths = [kept.keep(SOUND, {"n": n}) for n in range(5)]

    assert names(tmp_path) == [one.name for one in paths[2:]]
    assert len(names(tmp_path, "json")) == 3


def test_of_too_large_ones_the_oldest_are_deleted_and_the_newest_stays(tmp_path):
    kept = KeptAudio(tmp_path, most_bytes=80_000)
    paths = [kept.keep(SOUND, {}) for _ in range(4)]
    assert names(tmp_path) == [one.name for one in paths[2:]]

    large = kept.keep(np.zeros(100_000, np.int16), {})
    assert names(tmp_path) == [large.name]


def test_files_of_somebody_else_are_left_alone(tmp_path):
    (tmp_path / "mine.wav").write_bytes(b"x" * 1000)
    kept = KeptAudio(tmp_path, most_utterances=1, most_bytes=1)
    kept.keep(SOUND, {})
    kept.keep(SOUND, {})

    assert (tmp_path / "mine.wav").read_bytes() == b"x" * 1000
    assert len(names(tmp_path)) == 2


def test_it_goes_on_where_it_was_after_a_new_start(tmp_path):
    first = KeptAudio(tmp_path, most_utterances=2).keep(SOUND, {})
    again = KeptAudio(tmp_path, most_utterances=2)
    second, third = again.keep(SOUND, {}), again.keep(SOUND, {})

    assert first.name not in names(tmp_path)
    assert names(tmp_path) == [second.name, third.name]


@pytest.mark.parametrize("said", ["../../etc/passwd", "/root/x", "a\x00b", "…\n" * 99])
def test_what_is_said_names_no_file(tmp_path, said):
    folder = tmp_path / "in" / "kept"
    path = KeptAudio(folder).keep(SOUND, {"text": said})

    assert path.parent == folder
    assert json.loads(path.with_suffix(".json").read_text("utf-8"))["text"] == said
    assert [one.name for one in tmp_path.iterdir()] == ["in"]
    assert [one.name for one in (tmp_path / "in").iterdir()] == ["kept"]


@pytest.mark.parametrize("place", ["file", "file/in"])
def test_a_folder_that_cannot_be_is_refused_by_name(tmp_path, place):
    (tmp_path / "file").write_text("x")

    with pytest.raises(InvalidValue, match="keep_audio: got .*a folder that can be written"):
        KeptAudio(tmp_path / place)


class Words:
    """Speech to text that says the same each time, or fails."""

    def __init__(self, text="stop", error=None):
        self.text, self.error = text, error

    def transcribe(self, samples, language):
        if self.error:
            raise self.error
        return Transcript(self.text, 0.871_9, (Hypothesis("shop", 0.25, 0.5),))

    def warm_up(self, language):
        """Nothing to load."""

    def close(self):
        """Nothing to free."""


def kept_line(folder):
    (path,) = folder.glob("*.json")
    return json.loads(path.read_text("utf-8"))


def test_what_is_understood_is_kept_with_its_words(tmp_path):
    stt = KeepingSpeechToText(Words("stop"), KeptAudio(tmp_path))

    assert stt.transcribe(SOUND, "en").text == "stop"

    line = kept_line(tmp_path)
    assert (line["text"], line["language"], line["seconds"]) == ("stop", "en", 1.0)
    assert line["confidence"] == 0.872
    assert line["others"] == [{"text": "shop", "share": 0.25}]


def test_what_cannot_be_understood_is_kept_with_the_reason(tmp_path):
    stt = KeepingSpeechToText(Words(error=EdgeVoxError("no model")), KeptAudio(tmp_path))

    with pytest.raises(EdgeVoxError, match="no model"):
        stt.transcribe(SOUND, "en")

    assert kept_line(tmp_path)["failed"] == "no model"


def test_a_folder_that_is_gone_keeps_nobody_from_being_understood(tmp_path):
    kept = KeptAudio(tmp_path / "kept")
    kept.folder.rmdir()
    stt = KeepingSpeechToText(Words("stop"), kept)

    assert stt.transcribe(SOUND, "en").text == "stop"
    assert stt.failed == 1


def test_the_newest_stays_though_the_clock_has_gone_back(tmp_path):
    for suffix in ("wav", "json"):
        (tmp_path / f"heard-29991231T235959Z-000041.{suffix}").write_bytes(b"{}")
    kept = KeptAudio(tmp_path, most_utterances=1)

    newest = kept.keep(SOUND, {})

    assert names(tmp_path) == [newest.name]


def test_of_what_cannot_be_written_nothing_is_left(tmp_path, monkeypatch):
    kept = KeptAudio(tmp_path)

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(wave, "open", full)
    with pytest.raises(OSError, match="No space left"):
        kept.keep(SOUND, {})

    assert list(tmp_path.iterdir()) == []
