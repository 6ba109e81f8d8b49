"""Every text file is opened in an encoding that the code names, not the locale's."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLACES = ("benchmarks", "docs", "edgevox", "examples", "launch", "scripts", "training")
CODE = [ROOT / "docker" / "write_sbom", *(f for p in PLACES for f in (ROOT / p).rglob("*.py"))]
TEXTS = {"read_text": 0, "write_text": 1}
"""Where the encoding stands among the arguments of pathlib's methods, if it has no name."""


def guessed(file: Path) -> list[int]:
    """Lines that leave the encoding to the locale; ruff's PLW1514 sees them only on a `Path`."""
    code = file.read_bytes()
    if not any(method.encode() in code for method in TEXTS):
        return []  # without a look at its syntax, which takes a while
    calls = [n for n in ast.walk(ast.parse(code)) if isinstance(n, ast.Call)]
    methods = [call for call in calls if isinstance(call.func, ast.Attribute)]
    return [
        call.lineno
        for call in methods
        if call.func.attr in TEXTS
        and len(call.args) <= TEXTS[call.func.attr]
        and "encoding" not in {one.arg for one in call.keywords}
    ]


@pytest.mark.parametrize("file", CODE, ids=lambda file: str(file.relative_to(ROOT)))
def test_a_text_is_read_and_written_in_an_encoding_that_is_named(file):
    assert guessed(file) == []
