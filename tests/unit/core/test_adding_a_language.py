"""Every language has what the English one has, and is tried by the tests' own data."""

import tomllib
from pathlib import Path

import pytest

from edgevox.core.languages import CODES, language_file

TESTS = Path(__file__).parents[2]
OTHERS = [code for code in CODES if code != "en"]
ENTRIES = {
    "unit/stop_sentences.toml": tomllib.loads,
}
OPTIONAL = {"errors", "called_off", "own_names", "kokoro", "piper"}
"""What is for programs, and what a language may do without."""


@pytest.mark.parametrize("name", ENTRIES)
@pytest.mark.parametrize("code", OTHERS)
def test_a_language_is_tried_by_the_tests_data(code, name):
    entries = ENTRIES[name]((TESTS / name).read_text("utf-8"))

    assert code in entries, f"tests/{name} has no entry {code}: see docs/skills.md"


@pytest.mark.parametrize("folder", ["corpus", "talk"])
@pytest.mark.parametrize("code", OTHERS)
def test_a_language_has_a_corpus_and_is_talked_to(code, folder):
    file = TESTS / folder / f"{code}.yaml"

    assert file.is_file(), f"there is no tests/{folder}/{code}.yaml: see docs/skills.md"


@pytest.mark.parametrize("code", CODES)
def test_a_language_has_every_table_that_english_has(code):
    missing = language_file("en").keys() - language_file(code).keys() - OPTIONAL

    assert not missing, f"edgevox/core/languages/{code}.toml lacks {', '.join(sorted(missing))}"
