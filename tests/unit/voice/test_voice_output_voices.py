"""The catalogue of voices, and which of them speaks."""

from pathlib import Path

import pytest

from edgevox.apps.agent.queries import fetch_commands, list_languages
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES, Voice
from edgevox.models import Store
from edgevox.voice.tts.voices import PACKAGES, VoiceChoice, available, choose

EIGHT_WITH_KOKORO = {"en", "es", "fr", "hi", "it", "ja", "pt", "zh"}
EVERY_FILE = Path("/models")


def everything(model_id: str) -> Path | None:
    return EVERY_FILE / model_id


def nothing(model_id: str) -> Path | None:
    return None


def any_engine(voice: Voice) -> bool:
    return True


def names(found: tuple[VoiceChoice, ...]) -> list[str]:
    return [choice.name for choice in found]


def test_there_are_sixteen_languages_and_none_is_ever_silent():
    assert len(LANGUAGES) == 16
    for language in LANGUAGES.values():
        last = language.voices[-1]
        assert (last.name, last.models) == (f"espeak-{language.code}", ())


def test_eight_languages_have_kokoro_voices_and_they_are_54():
    kokoro = [
        (one.code, voice.name)
        for one in LANGUAGES.values()
        for voice in one.voices
        if voice.backend == "kokoro"
    ]
    assert {code for code, _ in kokoro} == EIGHT_WITH_KOKORO
    assert len({name for _, name in kokoro}) == len(kokoro) == 54


def test_every_model_of_the_catalogue_can_be_fetched():
    manifest = Store().manifest
    wanted = {one.stt_model for one in LANGUAGES.values()} | {
        model for one in LANGUAGES.values() for voice in one.voices for model in voice.models
    }
    assert wanted <= set(manifest.models)


def test_every_backend_is_known():
    found = {voice.backend for one in LANGUAGES.values() for voice in one.voices}
    assert "espeak" in found
    assert found - {"espeak"} <= set(PACKAGES)


def test_without_any_model_espeak_speaks():
    assert names(choose("de", "", nothing, any_engine)) == ["espeak-de"]


def test_with_every_model_the_best_voice_speaks_and_one_of_each_other_engine_is_in_reserve():
    found = choose("en", "", everything, any_engine)
    assert names(found) == ["en_US-joe-medium", "af_heart", "espeak-en"]


def test_a_voice_that_was_asked_for_comes_first():
    found = choose("en", "bf_emma", everything, any_engine)
    assert names(found) == ["bf_emma", "en_US-joe-medium", "espeak-en"]
    assert found[0].files == (EVERY_FILE / "kokoro-82m", EVERY_FILE / "kokoro-voices")


def test_a_voice_may_have_a_second_name():
    (first, *_) = choose("de", "de-thorsten", everything, any_engine)
    assert (first.name, first.voice.key) == ("de-thorsten", "de_DE-thorsten-medium")


@pytest.mark.parametrize("voice", ["ff_siwis", "de-thorsten", "nobody"])
def test_a_voice_of_another_language_or_of_nobody_is_refused(voice: str):
    with pytest.raises(InvalidValue, match="for the language es one of ef_dora"):
        choose("es", voice, everything, any_engine)


def test_a_voice_whose_engine_or_half_of_whose_files_are_missing_is_not_there():
    def only_model(model_id: str) -> Path | None:
        return None if model_id == "kokoro-voices" else EVERY_FILE

    assert names(available(LANGUAGES["fr"], only_model, any_engine)) == ["espeak-fr"]
    found = available(LANGUAGES["fr"], everything, lambda voice: voice.backend == "espeak")
    assert names(found) == ["espeak-fr"]


def test_an_empty_machine_says_for_every_language_what_fetches_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    said = list_languages()
    assert all(one["stt_backend"] is None for one in said.values())
    assert all(one["tts_backend"] == "espeak" for one in said.values())
    assert "edgevox-models fetch small" in said["en"]["missing"]
    assert "edgevox-models fetch world" in said["fr"]["missing"]
    assert "edgevox-models fetch standard" in said["de"]["missing"]


def test_a_command_is_said_once_and_only_for_what_can_be_fetched():
    assert fetch_commands(["kokoro-82m", "kokoro-voices", "nobody's"]) == [
        "edgevox-models fetch world"
    ]
