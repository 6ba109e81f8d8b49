"""Spoken to and answered in five languages, with switches between turns, and heard back.

Kokoro speaks the commands and, except in English, the answers; Whisper hears both.
"""

from typing import NamedTuple

import numpy as np
import pytest
from listener_rig import loud, says_espeak, silence
from voice_engines import words, wrong_words
from voice_rig import SLOWLY, says

from edgevox.agent.stop.words import SafetyWords
from edgevox.core.agent_events import AgentEvent
from edgevox.core.commands import SetLanguage
from edgevox.core.events import AudioLevel, Responded, Transcribed
from edgevox.voice.stt.speech_to_text import stop_first
from edgevox.voice.tts.voices import VoicePool

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def home_with():
    return {"speed": SLOWLY}


class Spoken(NamedTuple):
    voice: str
    command: str
    stop: str
    answer: str


SPOKEN = {
    "en": Spoken("af_bella", "Go to the kitchen.", "Stop!", "Going to the kitchen."),
    "fr": Spoken("ff_siwis", "Va dans la cuisine.", "Arrête-toi !", "Je vais à la cuisine."),
    "es": Spoken("ef_dora", "Ve a la cocina.", "¡Detente!", "Voy a la cocina."),
    "it": Spoken("if_sara", "Vai in cucina.", "Fermati!", "Vado in cucina."),
    "pt": Spoken("pf_dora", "Vá para a cozinha.", "Pare!", "Vou para a cozinha."),
}


@pytest.fixture(scope="module")
def pool():
    return VoicePool()


def in_a_room(sound):
    return np.concatenate([silence(0.5), loud(sound, 0.08), silence(1.0)])


def tell(rig, pool, language, text):
    rig.room.play(in_a_room(says(language, SPOKEN[language].voice, text, pool)))


def test_it_obeys_answers_and_stops_in_a_language_and_after_a_switch_in_another(rig, pool):
    for language, spoken in SPOKEN.items():
        rig.parts.command_router.submit(SetLanguage(language))
        rig.forget()
        rig.body.reset()

        tell(rig, pool, language, spoken.command)
        response = rig.wait_for(Responded).text
        said = rig.parts.voice.stt.transcribe(in_a_room(rig.answer()), language).text
        tell(rig, pool, language, spoken.stop)
        rig.wait_for(AgentEvent, lambda event: event.kind == "safety_preempt")
        # The sound of the word may have stopped it before its words are known.
        rig.wait_until(lambda: len(rig.of(Transcribed)) == 2)

        heard, _ = [event.text for event in rig.of(Transcribed)]
        assert wrong_words(words(spoken.command), words(heard)) <= 1
        assert rig.calls() == [("navigate_to", {"room": "kitchen"})]
        assert response == spoken.answer
        assert wrong_words(words(response), words(said)) <= 1
        assert rig.body.state()["goal"] is None


@pytest.mark.parametrize(("said", "stops"), [("إلغاء", True), ("نعم", False)])
def test_a_lone_stop_word_counts_where_only_stop_words_that_are_shown_tell_it(rig, said, stops):
    sound = np.concatenate([silence(0.3), says_espeak(said, "ar"), silence(0.2)])
    safety = SafetyWords("ar")

    heard = rig.parts.voice.stt.transcribe(sound, "ar")

    assert safety.find(heard.text) is None
    first = stop_first(heard, lambda text: safety.find(text) is not None)
    assert (safety.find(first.text) is not None) is stops


def test_muted_it_hears_nothing_and_unmuted_it_hears_again(rig, pool):
    rig.parts.command_router.submit(SetLanguage("en"))
    rig.parts.controls.change({"muted": True})
    tell(rig, pool, "en", SPOKEN["en"].command)
    levels_while_muted = rig.of(AudioLevel)
    rig.parts.controls.change({"muted": False})
    tell(rig, pool, "en", SPOKEN["en"].command)

    rig.wait_for(Responded)

    assert levels_while_muted == []
    assert rig.of(AudioLevel)
    assert len(rig.of(Transcribed)) == 1
