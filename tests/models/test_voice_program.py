"""The program as a person starts it, with a recording for a microphone and another for what it
says: espeak-ng speaks to it, Piper answers, Whisper listens to both.
"""

import sys
from pathlib import Path

import numpy as np
import phrases
from guards import run_program
from listener_rig import loud, noises, says_espeak, silence
from support.recordings import write_wav
from voice_engines import hear, words, wrong_words
from voice_rig import whole_wav

from edgevox.voice.audio import RATE_HZ, Chunk

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
COMMANDS = ("stop", "go to the bedroom")
ANSWERS = [
    phrases.said("standing"),
    phrases.begins("navigate_to", room="bedroom"),
    phrases.done("navigate_to", room="bedroom"),
]
CUT = "  [interrupted]"


def what_is_said(sound):
    """Without the waiting: Whisper hears half a minute at a time, and an answer may be late."""
    pieces = np.array_split(sound, max(1, sound.size // RATE_HZ))
    return np.concatenate([*[piece for piece in pieces if piece.any()], silence(0.5)])


def test_who_speaks_to_it_from_a_file_is_obeyed_and_answered_into_a_file(tmp_path):
    said, file = tmp_path / "said.wav", tmp_path / "answers.wav"
    pieces = [silence(0.5)]
    for command in COMMANDS:
        pieces += [loud(says_espeak(command, "en-us"), 0.08), silence(4.0)]
    sound = np.concatenate(pieces)
    hiss = loud(noises(sound.size / RATE_HZ)["hiss"], 0.002)
    write_wav(said, sound[: hiss.size] + hiss)

    done = run_program(
        [
            *(AGENT, "robot-apartment", "--no-render", "--llm", "none"),
            *("--audio-in", said, "--audio-out", file),
        ]
    )

    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    heard = [line[2:] for line in lines if line.startswith("> ")]
    # On a slow machine it still answers the first when the second is said.
    answered = [line.strip() for line in lines if line.startswith("  ") and line != CUT]
    assert [words(text) for text in heard] == [words(command) for command in COMMANDS]
    assert answered == ANSWERS
    aloud = hear([Chunk(what_is_said(whole_wav(file)), RATE_HZ)], "en")
    # Piper draws how it speaks, in a process of its own.
    assert 3 * wrong_words(words(" ".join(answered)), aloud) <= len(words(" ".join(answered)))
    assert done.stderr == ""
