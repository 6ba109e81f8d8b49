"""What robots say is what somebody has read: a change of words is seen, in every language."""

import pytest
from golden import recorded, spoken

from edgevox.core.languages import LANGUAGES


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_language_says_what_was_last_read_of_it(code):
    assert spoken(code) == recorded(code), "read it, then: python tests/talk/golden.py write"
