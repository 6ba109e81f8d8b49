"""Files of hearing and speaking that are cut short or go away, under a robot that runs.

What is cut short is a copy, and what goes away a link: neither happens to any other test.
"""

import os
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
from edgevox.voice.tts.voices import VoiceChoice, VoicePool

STT, JOE = "whisper-tiny.en", "piper-en_US-joe-medium"
QUESTION, ANSWER = "Where are you?", phrases.stands(room="living_room")
DEAF = phrases.said("deaf")


@pytest.fixture(scope="module")
def question():
    return np.concatenate([silence(0.5), loud(says_piper(QUESTION), 0.08), silence(2.0)])


@pytest.fixture
def store(tmp_path, monkeypatch) -> Path:
    """A folder of models with links to what hears and speaks English."""
    whole = {name: locate(name) for name in (STT, JOE)}
    for name, path in whole.items():
        folder = path if path.is_dir() else path.parent
        shutil.copytree(folder, tmp_path / "models" / name, copy_function=os.symlink)
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path / "models"))
    return tmp_path / "models"


def cut_short(file: Path) -> bytes:
    """Half of it is left, in a file of its own; what it was."""
    whole = file.read_bytes()
    file.unlink()
    file.write_bytes(whole[: len(whole) // 2])
    return whole


def ask(rig: VoiceRig, question) -> None:
    """It hears this, answers, and is heard."""
    rig.forget()
    rig.room.play(question)
    rig.wait_for(Responded, lambda event: ANSWER in event.text)
    assert rig.parts.conversation.wait_idle(HUNG_S)
    assert rig.answer().size


def voice_of(rig: VoiceRig) -> str:
    choice, _ = rig.parts.voice.speech_output.synthesiser.last
    return choice.backend


@pytest.mark.long
def test_what_is_cut_short_is_told_works_once_it_is_whole_and_is_not_missed_once_it_is_loaded(
    store, question, monkeypatch, tmp_path
):
    hearing, speaking = store / STT / "model.bin", store / JOE / "en_US-joe-medium.onnx"
    whole = {file: cut_short(file) for file in (hearing, speaking)}
    with VoiceRig(monkeypatch, tmp_path / "answers.wav", robot="robot-apartment") as rig:
        submit = rig.parts.command_router.submit
        rig.wait_for(Responded, lambda event: event.text == DEAF)
        assert f"edgevox-models fetch {STT}" in rig.parts.voice.stt.fault
        refused = "voice: got 'en_US-joe-medium', expected for the language en one"
        with pytest.raises(InvalidValue, match=refused):
            submit(SetVoice("en_US-joe-medium"))

        hearing.write_bytes(whole[hearing])
        ask(rig, question)
        assert rig.parts.voice.stt.fault == ""
        assert voice_of(rig) == "espeak"

        speaking.write_bytes(whole[speaking])
        submit(SetVoice("en_US-joe-medium"))
        ask(rig, question)
        assert voice_of(rig) == "piper"

        shutil.rmtree(store)
        ask(rig, question)
        assert voice_of(rig) == "piper"


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
