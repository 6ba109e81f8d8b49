"""Of the log only what belongs to a turn or a goal is told to who watches, and nobody's words."""

import logging
from collections.abc import Iterator
from typing import Any

import pytest
from logs_rig import logging_to_memory

from edgevox.core.log import Said, bound, get_logger
from edgevox.ops.logs.setup import MOST_CHARACTERS, MOST_LINES, TurnLines

log = get_logger("edgevox.tested_turn_lines")


@pytest.fixture
def told() -> Iterator[list[Any]]:
    told: list[Any] = []
    lines = TurnLines(told.append)
    level = logging.getLogger("edgevox").level
    logging.getLogger("edgevox").setLevel(logging.DEBUG)
    lines.open()
    yield told
    lines.close()
    logging.getLogger("edgevox").setLevel(level)


def test_a_line_of_a_turn_is_told_with_its_fields_and_the_length_of_what_was_said(told) -> None:
    log.warning("goal_failed", turn=3, skill="dance", text=Said("my secret"))
    assert told == [
        {
            "level": "warning",
            "event": "goal_failed",
            "turn": 3,
            "text": "skill=dance text=<9 characters>",
        }
    ]


def test_a_line_of_a_goal_without_a_turn_is_told_and_one_that_is_bound_to_a_turn(told) -> None:
    log.info("goal_started", goal="7")
    with bound(turn=4):
        log.info("answered")
    assert [(one["event"], one["turn"]) for one in told] == [("goal_started", 0), ("answered", 4)]


def test_what_belongs_to_no_turn_is_debugging_or_a_librarys_is_not_told(told) -> None:
    log.warning("console_paired", code="424242")
    log.debug("state", turn=3)
    with bound(turn=3):
        logging.getLogger("edgevox.not_structured").warning("password %s", "x")
        logging.getLogger("library").warning("token=x")
    assert told == []


def test_of_an_exception_only_its_kind_is_told(told) -> None:
    try:
        raise ValueError("what somebody said")
    except ValueError:
        log.exception("skill_broke", turn=3, skill="dance")
    assert [one["text"] for one in told] == ["skill=dance exception=ValueError"]


def test_a_line_is_short_and_a_flood_held_back(told) -> None:
    for _ in range(3 * MOST_LINES):
        log.warning("lost", turn=3, why="x\n" * MOST_CHARACTERS)
    assert len(told) == MOST_LINES
    assert all(len(one["text"]) == MOST_CHARACTERS and "\n" not in one["text"] for one in told)


def test_nothing_is_told_once_it_is_closed(told) -> None:
    lines = TurnLines(told.append)
    lines.open()
    lines.close()
    log.info("answered", turn=3)
    assert len(told) == 1  # by the one that is open


def test_the_programs_log_goes_on_telling_what_it_held_back() -> None:
    told: list[Any] = []
    with logging_to_memory() as logged:
        lines = TurnLines(told.append)
        lines.open()
        for _ in range(MOST_LINES + 2):
            log.warning("lost", turn=3)
    lines.close()
    (held,) = logged.of("lines_held_back")
    assert held["lines"] == 2
    assert len(told) == MOST_LINES
