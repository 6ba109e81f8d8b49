"""Files of hearing and speaking that are cut short or go away, under a robot that runs.

The files are copies, so that whatever happens to them happens to no other test.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from ears_rig import loud, silence
from guards import HUNG_S
from voice_stage import Stage, says

from edgevox.core.commands import SetVoice
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded
from edgevox.models import locate
from edgevox.voice.tts.pool import VoicePool

STT, JOE = "whisper-tiny.en", "piper-en_US-joe-medium"
QUESTION, ANSWER = "Where are you?", "I am in the living room"
DEAF = "I cannot understand speech right now: my hearing failed."


@pytest.fixture(scope="module")
def question():
    spoken = says("en", "en_US-joe-medium", QUESTION, VoicePool())
    return np.concatenate([silence(0.5), loud(spoken, 0.08), silence(2.0)])


@pytest.fixture
def store(tmp_path, monkeypatch) -> Path:
    """A folder of models with copies of what hears and speaks English."""
    whole = {name: locate(name) for name in (STT, JOE)}
    for name, path in whole.items():
        folder = path if path.is_dir() else path.parent
        shutil.copytree(folder, tmp_path / "models" / name)
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path / "models"))
    return tmp_path / "models"


@pytest.fixture
def stage(store, monkeypatch, tmp_path):
    made = []

    def start() -> Stage:
        made.append(Stage(monkeypatch, tmp_path / "answers.wav", robot="robot-apartment").start())
        return made[-1]

    yield start
    for one in made:
        one.close()


def cut_short(file: Path) -> bytes:
    """Half of it is left; what it was."""
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    return whole


def ask(stage: Stage, question, answer: str) -> None:
    stage.room.play(question)
    stage.wait_for(Responded, lambda event: answer in event.text)
    assert stage.parts.conversation.wait_idle(HUNG_S)


def voice_of(stage: Stage) -> str:
    choice, _ = stage.parts.voice.mouth.speaker.last
    return choice.backend


def test_files_that_go_away_are_not_missed_by_who_has_loaded_them(stage, store, question):
    one = stage()
    ask(one, question, ANSWER)

    shutil.rmtree(store)

    one.events.clear()
    ask(one, question, ANSWER)
    assert voice_of(one) == "piper"
    assert one.answer().size


def test_ears_whose_model_is_cut_short_say_so_and_hear_once_it_is_whole(stage, store, question):
    whole = cut_short(store / STT / "model.bin")
    one = stage()
    one.wait_for(Responded, lambda event: event.text == DEAF)
    assert f"edgevox-models fetch {STT}" in one.parts.voice.stt.trouble

    (store / STT / "model.bin").write_bytes(whole)

    ask(one, question, ANSWER)
    assert one.parts.voice.stt.trouble == ""


def test_a_voice_that_is_cut_short_is_refused_and_another_one_speaks(stage, store, question):
    cut_short(store / JOE / "en_US-joe-medium.onnx")
    one = stage()

    with pytest.raises(
        InvalidValue, match="voice: got 'en_US-joe-medium', expected for the language en one"
    ):
        one.parts.switchboard.submit(SetVoice("en_US-joe-medium"))

    ask(one, question, ANSWER)
    assert voice_of(one) == "espeak"
    assert one.answer().size
