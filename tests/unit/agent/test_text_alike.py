"""The most similar texts, held against difflib, which compares every pair."""

import difflib

from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.text.alike import most_alike

TEXTS = st.lists(st.text("abcdeé ", max_size=8) | st.text(max_size=5), max_size=12, unique=True)


@given(st.text("abcdeé ", max_size=8), TEXTS, st.integers(1, 4), st.sampled_from([0.0, 0.6, 0.8]))
def test_it_finds_what_difflib_finds(said, texts, most, least):
    def ratio(text):
        return difflib.SequenceMatcher(None, text, said).ratio()

    close = sorted((text for text in texts if ratio(text) >= least), key=ratio, reverse=True)

    assert most_alike(said, texts, most=most, least=least) == close[:most]


def test_letters_that_stand_apart_are_not_enough():
    assert most_alike("listen", ["silent", "kitchen"], least=0.7) == []
    assert most_alike("kichen", ["silent", "kitchen"], least=0.7) == ["kitchen"]
