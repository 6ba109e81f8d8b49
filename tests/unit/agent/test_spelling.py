"""The one spelling in which words are compared."""

import pytest

from edgevox.agent.text.spelling import TYPED_ALIKE, key


@pytest.mark.parametrize("apostrophe", "'`´‘’ʼʹ′＇")
def test_whatever_somebody_types_for_an_apostrophe_is_one(apostrophe):
    assert key(f"aujourd{apostrophe}hui") == key("aujourd'hui")


@pytest.mark.parametrize("letter", TYPED_ALIKE)
def test_letters_that_are_typed_for_each_other_are_one(letter):
    assert key(f"ka{letter}ak") == key(f"ka{TYPED_ALIKE[letter]}ak")
