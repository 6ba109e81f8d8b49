"""Tests ask for promises: none reaches into the private parts of what it tests."""

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest
from code_files import trees

TESTS = Path(__file__).parents[1]
BY_NAME = {"getattr", "setattr", "delattr", "hasattr", "object"}
"""What takes an attribute by its name, pytest's and unittest's ways to replace one included."""
OWN = {"self", "cls"}


def private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and name != "_"


def nodes(text: str) -> list[ast.AST]:
    return list(ast.walk(ast.parse(text)))


def defined(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """What the classes of a file call private themselves."""
    for one in nodes:
        match one:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                yield name
            case ast.Attribute(attr=name, ctx=ast.Store()) | ast.Name(id=name, ctx=ast.Store()):
                yield name


def private_parts(nodes: Iterable[ast.AST], own: set[str]) -> Iterator[str]:
    """Whatever is private and of somebody else in this file, as it is written there."""
    for one in nodes:
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
            called = getattr(one.func, "attr", None) or getattr(one.func, "id", "")
            said = [a.value for a in one.args if isinstance(a, ast.Constant)]
            names = [part for a in said if isinstance(a, str) for part in a.split(".")]
            if called in BY_NAME | {"patch"} and any(map(private, names)):
                yield ast.unparse(one)


def test_no_test_reaches_into_private_parts() -> None:
    files = {file: list(ast.walk(tree)) for file, tree in trees(TESTS, having=r"\b_(?!_)\w")}
    own = set().union(*map(defined, files.values()))

    found = [
        f"{file.relative_to(TESTS)}: {part}"
        for file, its in files.items()
        for part in private_parts(its, own)
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
    assert list(private_parts(nodes(written), own=set()))


@pytest.mark.parametrize(
    "written", ["self._own", "robot.pose()", "robot.__class__", "gettext._", "name('_total')"]
)
def test_what_is_ones_own_or_public_is_none(written: str) -> None:
    assert not list(private_parts(nodes(written), own={"_own"}))
