"""`edgevox listen`, as a person starts it on a recording: figures, words, and what is kept."""

import json
import sys

import numpy as np
import pytest
from guards import run_program
from listener_rig import loud, noises, says_espeak, says_piper, silence
from support.recordings import write_wav
from voice_engines import words

from edgevox.voice.audio import RATE_HZ

pytestmark = pytest.mark.long

LISTEN = (sys.executable, "-m", "edgevox.apps.edgevox", "listen")


def listen(*arguments):
    done = run_program([*LISTEN, *map(str, arguments)])
    return done.returncode, done.stdout.splitlines(), done.stderr


@pytest.fixture
def recording(tmp_path):
    """A command in the hiss of a room, 30 dB below it."""
    file = tmp_path / "said.wav"
    said = loud(says_espeak("go to the kitchen", "en-us"), 0.08)
    sound = np.concatenate([silence(1.0), said, silence(1.0)])
    write_wav(file, sound + loud(noises(sound.size / RATE_HZ)["hiss"], 0.0025)[: sound.size])
    return file


def test_a_recording_gives_figures_and_words_and_is_kept_if_asked(recording, tmp_path):
    folder = tmp_path / "kept"

    code, lines, errors = listen("--source", recording, "--keep-audio", folder)

    assert code == 0, errors
    assert any("signal/noise" in line and "speech" in line for line in lines)
    (heard,) = [line for line in lines if "heard" in line]
    assert words(heard)[1:] == words("go to the kitchen")
    assert "audio_is_kept" in errors
    kept = [json.loads(one.read_text("utf-8")) for one in sorted(folder.glob("*.json"))]
    assert words(kept[-1]["text"]) == words("go to the kitchen")
    assert len(list(folder.glob("*.wav"))) == len(kept)


def thought(lines, detector):
    """What a detector thought at most, line by line."""
    return [float(line.split(f" {detector} ")[1].split()[0]) for line in lines if "level" in line]


def test_the_wake_word_and_a_stop_word_by_its_sound_are_told_and_unasked_nothing_is_kept(tmp_path):
    file = tmp_path / "said.wav"
    pieces = [silence(1.5), says_piper("hey jarvis"), silence(1.5), says_espeak("Stop!")]
    write_wav(file, *pieces, silence(1.0))

    code, lines, errors = listen("--audio-in", file, "--wakeword", "hey jarvis")

    assert (code, errors) == (0, "")
    assert '  wake word "hey jarvis"' in lines
    assert thought(lines, "wake")[0] < 0.1 < 0.9 < max(thought(lines, "wake"))
    assert '  sounds like "stop"' in lines
    assert thought(lines, "stop")[0] < 0.1 < 0.8 < max(thought(lines, "stop"))
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("flags", "reason"),
    [
        (("--source", "gone.wav"), "audio_in: got 'gone.wav'"),
        (("--source", "none", "--keep-audio", "/proc/kept"), "keep_audio: got '/proc/kept'"),
    ],
)
def test_what_cannot_be_opened_is_a_wrong_command_line(flags, reason):
    code, _, errors = listen(*flags)

    assert code == 2
    assert reason in errors
    assert "Traceback" not in errors
