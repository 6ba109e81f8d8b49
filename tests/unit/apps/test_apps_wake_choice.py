"""Which networks hear the wake word: those that a product may use, unless others are asked for."""

import pytest

from edgevox.apps.agent.voice import needed_models, open_wakeword, phrases
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import load_settings
from edgevox.models import ModelMissing
from edgevox.models.manifest import builtin_manifest


def settings(**flags):
    return load_settings(flags)


def test_by_default_a_product_may_use_the_wake_words():
    manifest = builtin_manifest()

    (model,) = needed_models(settings(wakeword="hey jarvis"))

    assert manifest.allows_commercial_use(manifest.models[model])
    assert model in manifest.sets["small"]


def test_the_others_are_an_option():
    asked = settings(wakeword="hey rhasspy", wakeword_engine="openwakeword")
    assert needed_models(asked) == ("wake-words",)


def test_without_a_wake_word_or_with_ones_own_no_model_is_needed():
    assert needed_models(settings()) == needed_models(settings(wakeword="my/own.json")) == ()
    assert open_wakeword(settings()) is None


def test_a_phrase_that_the_other_engine_has_is_refused_with_that_hint():
    with pytest.raises(
        InvalidValue, match="one of alexa, hey jarvis.*set wakeword_engine to openw"
    ):
        open_wakeword(settings(wakeword="Hey  Rhasspy"))


def test_a_phrase_that_nobody_has_is_refused_with_those_that_are_known():
    with pytest.raises(InvalidValue, match="got 'hey you', expected one of alexa") as refused:
        open_wakeword(settings(wakeword="hey you"))

    assert "wakeword_engine" not in str(refused.value)


def test_networks_that_were_not_fetched_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))

    with pytest.raises(ModelMissing, match="fetch micro-wake-words"):
        open_wakeword(settings(wakeword="Hey_Jarvis"))


def test_each_engine_names_its_phrases():
    assert phrases("micro") == ["alexa", "hey jarvis", "hey mycroft", "okay nabu"]
    assert set(phrases("openwakeword")) == {*phrases("micro"), "hey rhasspy"}
