"""Mutation testing: break the code that keeps a robot safe, and see whether the tests find it.

    python scripts/mutate.py [--each 20] [--seed 1] [--workers 2] [MODULE...]

For each module of `MODULES` it draws mutations (a comparison turned, a condition negated, a call
left out, ...), applies one at a time in a copy of the project, and runs the module's tests, which
must fail. It prints each mutation that survived, and the share that was found. The same seed draws
the same mutations for as long as a module is unchanged. A mutation that changes nothing observable
survives.
"""

import argparse
import ast
import copy
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parent.parent
LONGEST_S = 120.0
"""A mutation that makes a test hang is found, too."""
MODULES = {
    "edgevox/agent/stop/stopping.py": (
        "conversation*",
        "stop_spotted",
        "what_a_stop_ends",
        "stop_game",
    ),
    "edgevox/agent/stop/words.py": ("stop_words", "dialogue_sentences", "answers"),
    "edgevox/agent/goals/lane.py": ("lane", "fault_skills", "conversation*"),
    "edgevox/agent/goals/executor.py": (
        *("skills*", "refusals_spoken", "conversation*", "what_a_stop_ends", "stop_game"),
        *("confirmation*", "policy*", "talk/test_talk.py"),
    ),
    "edgevox/agent/policy/policy.py": ("policy*", "wrong/test_wrong_files.py"),
    "edgevox/agent/policy/guard.py": ("policy*",),
    "edgevox/robots/command_mux.py": ("command_mux", "metrics_watchdog", "external_control"),
    "edgevox/ros2/contract.py": ("ros2_contract", "recorder_files", "apps_components"),
    "edgevox/voice/utterance_end.py": ("voice_listener*",),
    "edgevox/voice/listener.py": ("voice_listener*", "health_voice", "fault_sound"),
    "edgevox/models/fetch.py": ("models*", "fault_disk"),
}
"""Which tests must find what is broken in it: globs of files below tests, by default in `unit`."""
TURNED = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


@dataclass(frozen=True)
class Mutation:
    """One change: the source with it, and what people read of it."""

    module: str
    line: int
    what: str
    source: str


def mutations(module: str) -> Iterator[Mutation]:
    """All that can be done to a module, one change each."""
    tree = ast.parse((ROOT / module).read_text("utf-8"))
    nodes = list(ast.walk(tree))
    for number, node in enumerate(nodes):
        line = getattr(node, "lineno", 0)
        for what, change in _changes(node):
            mutated = copy.deepcopy(tree)
            change(list(ast.walk(mutated))[number])
            source = ast.unparse(ast.fix_missing_locations(mutated))
            yield Mutation(module, line, what, source)


def _changes(node: ast.AST) -> Iterator[tuple[str, Callable[..., None]]]:
    match node:
        case ast.Compare(ops=[op]) if type(op) in TURNED:
            turned = TURNED[type(op)]
            yield f"{_name(op)} became {turned.__name__}", lambda n: n.ops.__setitem__(0, turned())
        case ast.BinOp(op=op) | ast.BoolOp(op=op) if type(op) in TURNED:
            turned = TURNED[type(op)]
            yield f"{_name(op)} became {turned.__name__}", lambda n: setattr(n, "op", turned())
        case ast.If() | ast.While() | ast.IfExp():
            yield "condition negated", lambda n: setattr(n, "test", _not(n.test))
        case ast.Expr(value=ast.Call() | ast.Await()):
            yield (
                f"left out: {ast.unparse(node)[:60]}",
                lambda n: setattr(n, "value", ast.Constant(None)),
            )
        case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
            yield "returns None", lambda n: setattr(n, "value", ast.Constant(None))
        case ast.Return(value=ast.Constant(value=bool() as said)):
            yield f"returns {not said}", lambda n: setattr(n, "value", ast.Constant(not said))
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            yield f"{number} became {number + 1}", lambda n: setattr(n, "value", number + 1)
        case ast.Break():
            yield "break left out", lambda n: setattr(n, "__class__", ast.Pass)


def _name(node: ast.AST) -> str:
    return type(node).__name__


def _not(test: ast.expr) -> ast.expr:
    return ast.UnaryOp(ast.Not(), test)


def tests_of(module: str) -> list[str]:
    """The files of tests that must find it."""
    globs = [name if "/" in name else f"unit/**/test_{name}.py" for name in MODULES[module]]
    found = {file for each in globs for file in (ROOT / "tests").glob(each)}
    return sorted(str(file.relative_to(ROOT)) for file in found)


def is_found(mutation: Mutation, copied: Path, tests: list[str]) -> bool:
    """Whether a test fails with this mutation, in a copy of the project."""
    file = copied / mutation.module
    whole = file.read_text("utf-8")
    file.write_text(mutation.source, "utf-8")
    try:
        return _failed(copied, tests)
    finally:
        file.write_text(whole, "utf-8")


def _failed(copied: Path, tests: list[str]) -> bool:
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    environment = {**os.environ, "PYTHONPATH": str(copied), "PYTHONDONTWRITEBYTECODE": "1"}
    with subprocess.Popen(
        command, cwd=copied, env=environment, stdout=subprocess.DEVNULL, start_new_session=True,
        stderr=subprocess.DEVNULL,
    ) as run:  # fmt: skip
        try:
            return run.wait(LONGEST_S) != 0
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, 9)
            return True


def main() -> int:
    """Draw, apply, test, tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--each", type=int, default=20, help="mutations of a module, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("modules", nargs="*", metavar="MODULE", help=f"of: {', '.join(MODULES)}")
    asked = parser.parse_args()
    asked.modules = asked.modules or list(MODULES)
    if unknown := set(asked.modules) - set(MODULES):
        parser.error(f"{', '.join(sorted(unknown))}: expected some of {', '.join(MODULES)}")
    drawn: list[Mutation] = []
    for module in asked.modules:
        every = list(mutations(module))
        rng = random.Random(f"{asked.seed} {module}")  # noqa: S311
        drawn += rng.sample(every, min(asked.each, len(every)))
    with tempfile.TemporaryDirectory() as folder:
        free: Queue[Path] = Queue()
        for number in range(asked.workers):
            copied = Path(folder, str(number))
            ignored = shutil.ignore_patterns(".venv", "build", ".*_cache", "__pycache__")
            shutil.copytree(ROOT, copied, ignore=ignored, symlinks=True)
            (copied / ".venv").symlink_to(ROOT / ".venv")
            free.put(copied)
        for module in asked.modules:
            if _failed(copied, tests_of(module)):
                parser.error(f"the tests of {module} fail without any mutation")

        def tried(mutation: Mutation) -> bool:
            copied = free.get()
            try:
                return is_found(mutation, copied, tests_of(mutation.module))
            finally:
                free.put(copied)

        with ThreadPoolExecutor(asked.workers) as pool:
            found = list(pool.map(tried, drawn))
    for mutation, was_found in zip(drawn, found, strict=True):
        if not was_found:
            sys.stdout.write(f"survived: {mutation.module}:{mutation.line}: {mutation.what}\n")
    for module in asked.modules:
        mine = [one for one, m in zip(found, drawn, strict=True) if m.module == module]
        sys.stdout.write(f"{module}: {sum(mine)} of {len(mine)} found\n")
    sys.stdout.write(f"found: {sum(found)} of {len(found)} ({sum(found) / len(found):.0%})\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
