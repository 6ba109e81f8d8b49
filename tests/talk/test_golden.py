"""What robots say is what the golden files show: better words are a diff there."""

import pytest
from golden import FOLDER, text

from edgevox.core.languages import CODES


@pytest.mark.parametrize("code", CODES)
def test_a_language_says_what_its_golden_file_shows(code: str) -> None:
    golden = (FOLDER / f"{code}.toml").read_text("utf-8")

    assert text(code) == golden, "if that is meant: python tests/talk/golden.py write"


def test_no_golden_file_is_of_a_language_that_is_gone() -> None:
    assert {one.name for one in FOLDER.iterdir()} == {f"{code}.toml" for code in CODES}
