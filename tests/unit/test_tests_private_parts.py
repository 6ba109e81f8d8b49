"""Tests ask for promises: none reaches into the private parts of what it tests."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
BY_NAME = {"getattr", "setattr", "delattr", "hasattr", "object"}
"""What takes an attribute by its name, pytest's and unittest's ways to replace one included."""
OWN = {"self", "cls"}


def private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and name != "_"


def defined(tree: ast.AST) -> set[str]:
    """What the classes of a file call private themselves."""
    kinds = ast.FunctionDef | ast.AsyncFunctionDef
    functions = {one.name for one in ast.walk(tree) if isinstance(one, kinds)}
    stored = {
        one.attr if isinstance(one, ast.Attribute) else one.id
        for one in ast.walk(tree)
        if isinstance(one, ast.Attribute | ast.Name) and isinstance(one.ctx, ast.Store)
    }
    return functions | stored


def private_parts(tree: ast.AST, own: set[str]) -> Iterator[str]:
    """Whatever is private and of somebody else in this file, as it is written there."""
    for one in ast.walk(tree):
        if isinstance(one, ast.Attribute) and private(one.attr):
            of_itself = isinstance(one.value, ast.Name) and one.value.id in OWN
            if not (of_itself and one.attr in own):
                yield ast.unparse(one)
        elif isinstance(one, ast.Import | ast.ImportFrom):
            module = one.module or "" if isinstance(one, ast.ImportFrom) else ""
            names = ".".join([module, *(alias.name for alias in one.names)])
            if any(map(private, names.split("."))):
                yield ast.unparse(one)
        elif isinstance(one, ast.Call):
            called = one.func.attr if isinstance(one.func, ast.Attribute) else ast.unparse(one.func)
            said = [a.value for a in one.args if isinstance(a, ast.Constant)]
            names = [part for a in said if isinstance(a, str) for part in a.split(".")]
            if called in BY_NAME | {"patch"} and any(map(private, names)):
                yield ast.unparse(one)


def test_no_test_reaches_into_private_parts() -> None:
    trees = {file: ast.parse(file.read_text(encoding="utf-8")) for file in TESTS.rglob("*.py")}
    own = set().union(*map(defined, trees.values()))

    found = [
        f"{file.relative_to(TESTS)}: {part}"
        for file, tree in trees.items()
        for part in private_parts(tree, own)
    ]

    assert found == []


@pytest.mark.parametrize(
    "written",
    [
        "robot._engine",
        "robot._link._client.ready()",
        "self._of_the_base_class",
        "from edgevox.core.bus import _unsubscribe",
        "import edgevox._secret",
        "from edgevox._secret import part",
        "monkeypatch.setattr(robot, '_engine', None)",
        "monkeypatch.setattr('edgevox.core.bus._log', None)",
        "getattr(robot, '_engine')",
        "mock.patch.object(robot, '_engine')",
    ],
)
def test_every_way_to_reach_in_is_seen(written: str) -> None:
    assert list(private_parts(ast.parse(written), own=set()))


@pytest.mark.parametrize(
    "written", ["self._own", "robot.pose()", "robot.__class__", "gettext._", "name('_total')"]
)
def test_what_is_ones_own_or_public_is_none(written: str) -> None:
    assert not list(private_parts(ast.parse(written), own={"_own"}))
