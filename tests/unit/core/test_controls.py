import pytest

from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged

VOICES = {"en": ["joe", "af_bella"], "fr": ["ff_siwis"]}


@pytest.fixture
def rig():
    bus, heard = Bus(), []
    bus.subscribe(ControlChanged, lambda e: heard.append((e.name, e.value)))
    controls = Controls(bus, language="en", voices=lambda code: VOICES.get(code, []))
    return controls, heard


def test_a_change_is_told_once(rig):
    controls, heard = rig
    controls.change({"voice": "af_bella"})
    controls.change({"voice": "af_bella"})
    assert controls.voice == "af_bella"
    assert heard == [("voice", "af_bella")]


def test_another_language_drops_the_voice_of_the_old_one(rig):
    controls, heard = rig
    controls.change({"voice": "af_bella"})
    controls.change({"language": "fr"})
    assert (controls.language, controls.voice) == ("fr", "")
    assert heard[1:] == [("language", "fr"), ("voice", "")]


@pytest.mark.parametrize("tag", ["fr-FR", "fr_FR.UTF-8", "FR", " fr-Latn-CA", "fr@euro"])
def test_a_language_may_be_named_by_its_tag_or_locale(rig, tag):
    controls, heard = rig
    controls.change({"language": tag})
    assert controls.language == "fr"
    assert ("language", "fr") in heard


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"language": "xx"}, "language: got 'xx', expected one of en, es"),
        ({"language": "C.UTF-8"}, "language: got 'C.UTF-8', expected one of en, es"),
        ({"voice": "ff_siwis"}, "voice: got 'ff_siwis', expected for the language en one of joe"),
        ({"language": "de", "voice": "joe"}, "no voice of this language is on this machine"),
        ({"muted": "yes"}, "muted: got 'yes', expected true or false"),
        ({"confirm": "yes"}, "confirm: got 'yes', expected one of always, unsure, never"),
        ({"muted": True, "language": "xx"}, "language: got 'xx'"),
    ],
)
def test_what_cannot_be_honoured_is_refused_and_nothing_changes(rig, wanted, message):
    controls, heard = rig
    with pytest.raises(InvalidValue) as refused:
        controls.change(wanted)
    assert message in str(refused.value)
    assert (controls.language, controls.voice, controls.muted) == ("en", "", False)
    assert heard == []


def test_when_it_asks_back_is_a_control(rig):
    controls, heard = rig
    assert controls.confirm == "unsure"
    controls.change({"confirm": "always"})
    assert (controls.confirm, heard) == ("always", [("confirm", "always")])


def test_language_and_voice_change_together(rig):
    controls, _ = rig
    controls.change({"language": "fr", "voice": "ff_siwis"})
    assert (controls.language, controls.voice) == ("fr", "ff_siwis")
