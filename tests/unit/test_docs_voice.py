"""The tables of docs/voice.md say what the catalogue, the state machine and the settings say."""

import re
from pathlib import Path

import pytest

from edgevox.agent.states import TRANSITIONS
from edgevox.apps.wake_choice import phrases
from edgevox.core.ending import Ending
from edgevox.core.events import TurnMeasured
from edgevox.core.languages import LANGUAGES
from edgevox.core.settings import Settings
from edgevox.models.manifest import builtin_manifest
from edgevox.voice.listener import ENDS_AFTER_S
from edgevox.voice.wake_gate import FOLLOW_S, SHORT_S

PAGE = (Path(__file__).parents[2] / "docs" / "voice.md").read_text()


def table(heading):
    """The rows below a heading, as lists of cells."""
    section = re.search(rf"^#+ {heading}\n(.*?)(?=^#+ |\Z)", PAGE, re.MULTILINE | re.DOTALL)[1]
    lines = [line for line in section.splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]


def quoted(cell):
    return re.findall(r"`(.+?)`", cell)


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_language_has_its_row_with_its_voices_and_stop_words(code):
    (row,) = [row for row in table("Languages and voices") if row[0] == f"`{code}`"]
    language = LANGUAGES[code]
    assert row[1] == language.name
    assert quoted(row[2]) == [voice.name for voice in language.voices]
    assert set(row[3].split(", ")) <= set(language.stop.anywhere)


def test_no_other_language_has_a_row():
    assert [row[0].strip("`") for row in table("Languages and voices")] == list(LANGUAGES)


def test_words_that_stop_only_at_an_end_or_alone_are_told():
    assert {"para", "pare"} <= set(LANGUAGES["es"].stop.last)
    assert {"para", "parar"} <= set(LANGUAGES["pt"].stop.last)
    assert {"wait", "enough"} <= set(LANGUAGES["en"].stop.alone)
    assert all(f"`{word}`" in PAGE for word in ("para", "pare", "parar", "wait", "enough"))


def test_what_hears_each_language_is_told_truly():
    sets = builtin_manifest().sets
    heard = {code: language.stt_model for code, language in LANGUAGES.items()}
    assert heard.pop("en") == "whisper-tiny.en"
    assert set(heard.values()) == {"whisper-base"}
    assert "whisper-tiny.en" in sets["small"]
    assert "whisper-base" in sets["world"]


def test_every_state_has_its_row_with_the_states_that_follow():
    told = {quoted(row[0])[0]: set(quoted(row[2])) for row in table("States")}
    assert told == {str(state): set(map(str, after)) for state, after in TRANSITIONS.items()}


def test_every_key_of_metrics_has_its_row():
    told = [quoted(row[0])[0] for row in table("What a turn took")]
    assert told == [name for name in TurnMeasured.__slots__ if name != "turn"]


def test_every_wake_word_is_named():
    for phrase in {*phrases("micro"), *phrases("openwakeword")}:
        assert phrase in PAGE


def test_the_times_on_the_page_are_those_of_the_code():
    assert f"within {FOLLOW_S:g} s" in PAGE
    assert f"up to {SHORT_S:g} s" in PAGE
    for ending in (Ending.MAY_GO_ON, Ending.OPEN, Ending.BROKEN_OFF):
        assert f"| {ENDS_AFTER_S[ending]:g} s |" in PAGE


def test_every_flag_on_the_page_is_a_setting():
    page = re.sub(r"\npython3 .*|--once", "", PAGE)
    flags = set(re.findall(r"--(?:no-)?([a-z][a-z0-9-]+)", page))
    settings = {name.replace("_", "-") for name in Settings.model_fields}
    assert flags <= settings


def test_models_that_must_not_be_used_commercially_are_named():
    manifest = builtin_manifest()
    forbidden = {
        model.id for model in manifest.models.values() if not manifest.allows_commercial_use(model)
    }
    assert forbidden == {"wake-words", "piper-tr_TR-dfki-medium"}
    licences = PAGE.partition("## Licences")[2]
    assert "Wake words: CC BY-NC-SA 4.0" in licences
    assert "Turkish voice dfki: CC BY-NC-SA 4.0" in licences
