import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.safety import SafetyWords
from edgevox.core.languages import LANGUAGES


@pytest.mark.parametrize(
    "text",
    [
        "stop",
        "Stop!",
        "STOP—now",
        "please stop",
        "hold it there, stop",
        "go to the kitchen, no, halt",
        "x" * 100_000 + " freeze",
    ],
)
def test_a_stop_word_halts_wherever_it_stands(text):
    assert SafetyWords("en").find(text)


@pytest.mark.parametrize(
    "text", ["don't stop", "Don’t stop", "non-stop music", "it stopped", "go to the kitchen", ""]
)
def test_no_halt_without_a_stop_word_or_with_a_negated_one(text):
    assert SafetyWords("en").find(text) is None


@pytest.mark.parametrize(
    ("code", "word"),
    [(code, w) for code, one in LANGUAGES.items() for w in (*one.stop_words, *one.stop_alone)],
)
def test_every_stop_word_of_every_language_halts_alone(code, word):
    assert SafetyWords(code).find(word)
    assert SafetyWords(code).find(f"{word.upper()}!")


@pytest.mark.parametrize("code", LANGUAGES)
def test_english_stop_words_count_in_every_language(code):
    assert SafetyWords(code).find("stop")


@pytest.mark.parametrize(
    ("code", "text"), [("pt", "vá para a cozinha"), ("es", "ve para la cocina"), ("pt", "não pare")]
)
def test_a_preposition_that_sounds_like_a_stop_word_does_not_halt(code, text):
    assert SafetyWords(code).find(text) is None


@given(st.lists(st.sampled_from(["go", "to", "kitchen", "please", "ok", "7"]), max_size=6))
def test_stop_after_any_other_words_halts(words):
    assert SafetyWords("en").find(" ".join([*words, "stop"])) == "stop"
    assert SafetyWords("en").find(" ".join(["stop", *words])) == "stop"


@given(st.sampled_from(sorted(LANGUAGES)), st.text(max_size=300))
def test_any_text_is_searched_without_failing(code, text):
    found = SafetyWords(code).find(text)
    assert found is None or found
