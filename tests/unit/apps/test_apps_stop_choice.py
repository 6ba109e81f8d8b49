"""Whether stop words are heard by their sound: asked for, its model here, and loaded when."""

import pytest

from edgevox.apps.agent import voice
from edgevox.core.settings import Settings
from edgevox.models import Store
from edgevox.models.store import ModelMissing


class Spotter:
    def __init__(self, broken=""):
        self.broken, self.warm = broken, False

    def warm_up(self):
        if self.broken:
            raise RuntimeError(self.broken)
        self.warm = True


@pytest.fixture
def spotter(monkeypatch):
    one = Spotter()
    monkeypatch.setattr(voice, "locate", lambda _: None)
    monkeypatch.setattr(voice, "open_stop_spotter", lambda _: one)
    return one


def test_it_is_loaded_before_somebody_says_a_word(spotter):
    assert voice.open_stop_detector(Settings()) is spotter
    assert spotter.warm


def test_english_stop_words_count_whatever_is_spoken(spotter):
    assert voice.open_stop_detector(Settings(language="de")) is spotter
    assert spotter.warm


def test_who_does_not_want_it_has_none(spotter):
    assert voice.open_stop_detector(Settings(stop_spotter=False)) is None
    assert not spotter.warm


def test_without_its_model_the_robot_starts_and_says_so(monkeypatch, caplog):
    def missing(name):
        model = Store().manifest.models[name]
        raise ModelMissing(model, Store().folder(model), model.files)

    monkeypatch.setattr(voice, "locate", missing)

    assert voice.open_stop_detector(Settings()) is None
    assert "stop_spotter_missing" in caplog.text
    assert "edgevox-models fetch whisper-tiny.en" in caplog.text


def test_a_model_that_cannot_be_loaded_leaves_the_robot_its_hearing(spotter, caplog):
    spotter.broken = "no memory"

    assert voice.open_stop_detector(Settings()) is None
    assert "no memory" in caplog.text
