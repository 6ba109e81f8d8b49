"""Files of hearing and speaking that are cut short or go away, under a robot that runs.

The files are copies, so that whatever happens to them happens to no other test.
"""

import shutil
from pathlib import Path

import numpy as np
import phrases
import pytest
from guards import HUNG_S
from listener_rig import loud, says_piper, silence
from voice_rig import VoiceRig

from edgevox.core.commands import SetVoice
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import Responded
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.tts.pool import VoicePool
from edgevox.voice.voices import VoiceChoice

STT, JOE = "whisper-tiny.en", "piper-en_US-joe-medium"
QUESTION, ANSWER = "Where are you?", phrases.stands(room="living_room")
DEAF = phrases.said("deaf")


@pytest.fixture(scope="module")
def question():
    return np.concatenate([silence(0.5), loud(says_piper(QUESTION), 0.08), silence(2.0)])


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
def rig(store, monkeypatch, tmp_path):
    made = []

    def start() -> VoiceRig:
        made.append(
            VoiceRig(monkeypatch, tmp_path / "answers.wav", robot="robot-apartment").start()
        )
        return made[-1]

    yield start
    for one in made:
        one.close()


def cut_short(file: Path) -> bytes:
    """Half of it is left; what it was."""
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    return whole


def ask(rig: VoiceRig, question, answer: str) -> None:
    rig.room.play(question)
    rig.wait_for(Responded, lambda event: answer in event.text)
    assert rig.parts.conversation.wait_idle(HUNG_S)


def voice_of(rig: VoiceRig) -> str:
    choice, _ = rig.parts.voice.speech_output.synthesiser.last
    return choice.backend


@pytest.mark.long
def test_files_that_go_away_are_not_missed_by_who_has_loaded_them(rig, store, question):
    one = rig()
    ask(one, question, ANSWER)

    shutil.rmtree(store)

    one.events.clear()
    ask(one, question, ANSWER)
    assert voice_of(one) == "piper"
    assert one.answer().size


@pytest.mark.long
def test_hearing_whose_model_is_cut_short_says_so_and_works_once_it_is_whole(rig, store, question):
    whole = cut_short(store / STT / "model.bin")
    one = rig()
    one.wait_for(Responded, lambda event: event.text == DEAF)
    assert f"edgevox-models fetch {STT}" in one.parts.voice.stt.fault

    (store / STT / "model.bin").write_bytes(whole)

    ask(one, question, ANSWER)
    assert one.parts.voice.stt.fault == ""


@pytest.mark.long
def test_a_voice_that_is_cut_short_is_refused_and_another_one_speaks(rig, store, question):
    cut_short(store / JOE / "en_US-joe-medium.onnx")
    one = rig()

    with pytest.raises(
        InvalidValue, match="voice: got 'en_US-joe-medium', expected for the language en one"
    ):
        one.parts.command_router.submit(SetVoice("en_US-joe-medium"))

    ask(one, question, ANSWER)
    assert voice_of(one) == "espeak"
    assert one.answer().size


@pytest.mark.parametrize("name", ["model.bin", "tokenizer.json"])
@pytest.mark.parametrize("fault", [cut_short, Path.unlink])
def test_hearing_with_a_file_that_is_cut_short_or_gone_fails_with_a_reason(store, name, fault):
    fault(store / STT / name)

    with pytest.raises(EdgeVoxError, match="cannot load"):
        Whisper(lambda _: store / STT).warm_up("en")


@pytest.mark.parametrize("fault", [cut_short, Path.unlink])
@pytest.mark.parametrize("name", ["en_US-joe-medium.onnx", "en_US-joe-medium.onnx.json"])
def test_a_voice_whose_file_goes_away_while_it_is_chosen_fails_with_a_reason(store, name, fault):
    (voice,) = (one for one in LANGUAGES["en"].voices if one.models == (JOE,))
    fault(store / JOE / name)

    with pytest.raises(EdgeVoxError, match="en_US-joe-medium"):
        VoicePool().get(VoiceChoice("en", voice, (store / JOE / "en_US-joe-medium.onnx",)))
