"""A fault that repeats is held back, and never in silence."""

import logging

from hypothesis import given
from hypothesis import strategies as st
from support.clock import HeldClock

from edgevox.core.log import LogLine
from edgevox.ops.logs.setup import HELD_BACK, MOST_EVENTS, MOST_LINES, WINDOW_S, RateLimit


class Lines(logging.Handler):
    """Keeps what passed the limit."""

    def __init__(self, clock):
        super().__init__()
        self.limit = RateLimit(clock)
        self.addFilter(self.limit)
        self.seen = []

    def emit(self, record):
        told = record.msg if isinstance(record.msg, LogLine) else LogLine(event=record.getMessage())
        self.seen.append((record.levelno, dict(told)))

    def events(self):
        return [told["event"] for _, told in self.seen]

    def held(self):
        return [told for _, told in self.seen if told["event"] == HELD_BACK]


def limited(name):
    clock, logger = HeldClock(), logging.getLogger(f"limited.{name}")
    handler = Lines(clock)
    logger.handlers, logger.propagate = [handler], False
    logger.setLevel(logging.DEBUG)
    return clock, logger, handler


def warn(logger, event, level=logging.WARNING):
    logger.log(level, LogLine(event=event))


def test_of_a_fault_the_first_lines_pass_and_the_rest_is_counted_when_the_window_is_over():
    clock, logger, handler = limited("fault")
    for _ in range(20):
        warn(logger, "lost")
    assert handler.events() == ["lost"] * MOST_LINES
    clock.now_s = WINDOW_S + 1
    warn(logger, "something else")
    assert handler.held() == [
        {"event": HELD_BACK, "of": "lost", "lines": 20 - MOST_LINES, "window_s": WINDOW_S}
    ]
    warn(logger, "lost")
    assert handler.events()[-1] == "lost"


def test_the_count_comes_before_the_next_line_of_the_same_fault():
    clock, logger, handler = limited("next")
    for _ in range(MOST_LINES + 2):
        warn(logger, "lost", logging.ERROR)
    clock.now_s = WINDOW_S
    warn(logger, "lost", logging.ERROR)
    assert handler.events()[-2:] == [HELD_BACK, "lost"]
    assert {level for level, _ in handler.seen} == {logging.ERROR}


def test_lines_that_are_no_faults_are_never_held_back():
    _, logger, handler = limited("turns")
    for _ in range(100):
        warn(logger, "turn_ended", logging.INFO)
    assert len(handler.seen) == 100


def test_at_the_end_what_was_held_back_is_told():
    _, logger, handler = limited("end")
    for _ in range(MOST_LINES + 3):
        warn(logger, "lost")
    handler.limit.tell()
    assert [told["lines"] for told in handler.held()] == [3]


def test_a_librarys_lines_that_differ_in_numbers_are_one_fault():
    _, logger, handler = limited("library")
    for number in range(20):
        logger.warning(f"try {number} failed")
    assert len(handler.seen) == MOST_LINES


def test_two_handlers_agree_on_a_line():
    clock, logger, handler = limited("two")
    other = Lines(clock)
    logger.addHandler(other)
    for _ in range(20):
        warn(logger, "lost")
    assert handler.events() == other.events() == ["lost"] * MOST_LINES


def test_of_more_events_than_are_counted_the_one_silent_longest_is_told_and_forgotten():
    _, logger, handler = limited("bounded")
    for _ in range(20):
        warn(logger, "first")
    for number in range(MOST_EVENTS - 1):
        warn(logger, f"event {number}")
    assert not handler.held()
    warn(logger, "one more")
    assert [told["of"] for told in handler.held()] == ["first"]
    warn(logger, "first")
    assert handler.events()[-1] == "first"


@given(st.lists(st.tuples(st.integers(0, 600), st.floats(0, 5)), max_size=700))
def test_the_first_line_of_an_event_always_passes_and_none_is_lost(lines):
    clock, logger, handler = limited("many")
    first = set()
    for number, pause_s in lines:
        clock.now_s += pause_s
        before = len(handler.seen)
        warn(logger, f"event {number}")
        if number not in first:
            assert handler.events()[before:][-1] == f"event {number}"
        first.add(number)
    handler.limit.tell()
    held = sum(told["lines"] for told in handler.held())
    passed = len(handler.seen) - len(handler.held())
    assert held + passed == len(lines)
