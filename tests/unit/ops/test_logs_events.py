"""The table of events and the code are the same."""

import ast
import re
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

from code_files import trees

import edgevox
from edgevox.core.log import Said
from edgevox.ops.logs.line_formatter import IDS, LAST

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts"))

from docs.operating import log_events

CODE = Path(edgevox.__file__).parent
METHODS = {"debug", "info", "warning", "error", "exception", "critical", "log"}
OF_THE_LOG_ITSELF = {"lines_held_back", "log_lines_lost", "log_line_broken"}
COMMON = {"ts", "level", "logger", "event", *IDS, LAST, "exc_info"}


@cache
def calls():
    """Every call of a module's `log`: where, the method, the call."""
    return tuple(_calls())


def _calls():
    for file, tree in trees(CODE, having=r"\blog\b"):
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                continue
            named = isinstance(node.func.value, ast.Name) and node.func.value.id == "log"
            if named and node.func.attr in METHODS:
                yield f"{file.relative_to(CODE)}:{node.lineno}", node.func.attr, node


def in_code():
    """Levels and fields by event; `open` are those whose lines take more fields by ``**``."""
    levels, fields, open_ended = defaultdict(set), defaultdict(set), set()
    for where, method, call in calls():
        *level, event = call.args
        assert isinstance(event, ast.Constant), f"{where}: an event is named by a literal"
        name = event.value
        assert re.fullmatch("[a-z][a-z0-9_]+", name), f"{where}: {name}"
        assert len(level) == (method == "log"), where
        levels[name].add("" if method == "log" else method)
        given = {one.arg for one in call.keywords}
        open_ended |= {name} if None in given else set()
        fields[name] |= given - COMMON - {None}
    return levels, fields, open_ended


def test_every_event_is_in_the_table_and_every_row_in_the_code():
    levels, _, _ = in_code()
    assert set(levels) == set(log_events()) - OF_THE_LOG_ITSELF


def test_levels_and_fields_are_those_of_the_table():
    levels, fields, open_ended = in_code()
    for name in levels:
        row = log_events()[name]
        said = set(row.level.split(", "))
        assert levels[name] <= said | {""}, name
        if name in open_ended:
            assert fields[name] <= set(row.fields), name
        else:
            assert fields[name] == set(row.fields), name


def test_no_row_takes_a_name_that_every_line_has():
    assert not {name for name, row in log_events().items() if set(row.fields) & COMMON}


def test_nothing_logs_past_the_table():
    """Python's own loggers are for what is no event: levels, handlers, another's lines."""
    lost = re.compile(r"logging\.getLogger\([^)]*\)\.(debug|info|warning|error|exception)\(")
    past = [str(f) for f in CODE.rglob("*.py") if lost.search(f.read_text())]
    assert past == []
    rclpy = re.compile(r"get_logger\(\)\.(debug|info|warning|error|fatal)\(")
    assert [str(f) for f in CODE.rglob("*.py") if rclpy.search(f.read_text())] == []


def test_what_may_be_speech_is_given_as_such():
    for where, _, call in calls():
        for one in call.keywords:
            if one.arg in {"text", "said", "words", "sentence"}:
                assert ast.unparse(one.value).startswith(f"{Said.__name__}("), where
