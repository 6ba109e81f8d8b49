"""Two habits of our code that no linter holds it to as far as we need."""

import ast
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pytest
from code_files import trees

ROOT = Path(__file__).parents[3]
CODE = ("benchmarks", "docs", "edgevox", "examples", "launch", "scripts")
SBOM = ROOT / "docker" / "write_sbom"
TEXTS = {"read_text": 0, "write_text": 1}
"""Where the encoding stands among the arguments of pathlib's methods, if it has no name."""
BY_NAME = {"getattr", "setattr", "delattr", "hasattr", "object", "patch"}
"""What takes an attribute by its name, pytest's and unittest's ways to replace one included."""


def calls(tree: ast.AST) -> Iterator[tuple[str, ast.Call]]:
    """Every call, with the last part of the name of what is called."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield ast.unparse(node.func).rpartition(".")[2], node


def guessed(tree: ast.AST) -> Iterator[int]:
    """Lines that leave a text's encoding to the locale; PLW1514 sees them only on a `Path`."""
    for name, call in calls(tree):
        named = "encoding" in {one.arg for one in call.keywords}
        if name in TEXTS and len(call.args) <= TEXTS[name] and not named:
            yield call.lineno


def private_by_name(tree: ast.AST) -> Iterator[int]:
    """Lines that reach a private part by a string, which SLF001 and PLC2701 do not see."""
    for name, call in calls(tree):
        said = [one.value for one in call.args if isinstance(one, ast.Constant)]
        parts = [part for one in said if isinstance(one, str) for part in one.split(".")]
        if name in BY_NAME and any(p.startswith("_") and not p.startswith("__") for p in parts):
            yield call.lineno


def test_every_text_is_read_and_written_in_an_encoding_that_is_named() -> None:
    files = chain(
        *(trees(ROOT / one, having="|".join(TEXTS)) for one in CODE),
        [(SBOM, ast.parse(SBOM.read_text("utf-8")))],
    )

    assert [f"{file}:{line}" for file, tree in files for line in guessed(tree)] == []


def test_no_test_reaches_a_private_part_by_its_name() -> None:
    files = trees(ROOT / "tests", having=r"[\"'.]_(?!_)\w")

    assert [f"{file}:{line}" for file, tree in files for line in private_by_name(tree)] == []


@pytest.mark.parametrize(
    "written",
    [
        "monkeypatch.setattr(robot, '_engine', None)",
        "monkeypatch.setattr('edgevox.core.bus._log', None)",
        "getattr(robot, '_engine')",
        "mock.patch.object(robot, '_engine')",
        "file.read_text()",
        "file.write_text(words)",
    ],
)
def test_what_breaks_a_habit_is_found(written: str) -> None:
    assert [*guessed(ast.parse(written)), *private_by_name(ast.parse(written))]
