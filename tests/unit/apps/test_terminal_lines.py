"""Lines of a pipe: each in its order, a stop before all that waits."""

import os
import threading
from contextlib import contextmanager

import pytest
from guards import HUNG_S
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.text.reasons import because
from edgevox.apps.terminal.run_terminal import (
    MAX_AHEAD_BYTES,
    MAX_LINE_BYTES,
    InputLines,
    Splitter,
    typed_ahead,
)
from edgevox.core.motion.interlock import Interlock


def is_stop(line):
    return line == "stop"


class Pipe:
    """Both ends of a pipe with `InputLines` at one of them, and what was stopped and begun."""

    def __init__(self):
        self.stops, self.stopped = [], threading.Event()
        reading, self.writing = os.pipe()
        self.reading = reading
        self.interlock = Interlock()
        self.lines = InputLines(
            reading, is_stop=is_stop, on_stop=self._stop, interlock=self.interlock
        )

    def _stop(self, line, dropped):
        self.stops.append((line, dropped))
        self.stopped.set()

    def is_stopped_elsewhere(self):
        def stop():
            with self.interlock.stopping(because("interrupted")):
                """Nothing moves here."""

        elsewhere = threading.Thread(target=stop)
        elsewhere.start()
        elsewhere.join()

    def write(self, text):
        os.write(self.writing, text.encode())

    def end(self):
        os.close(self.writing)

    def rest(self):
        """All lines until the end."""
        return list(iter(lambda: self.lines.take(lambda *_: None), None))


@contextmanager
def a_pipe():
    pipe = Pipe()
    try:
        yield pipe
    finally:
        pipe.lines.close()
        os.close(pipe.reading)


def test_a_stop_is_told_while_nobody_takes_lines_and_what_waited_is_forgotten():
    with a_pipe() as pipe:
        pipe.lines.start()
        pipe.write("go to the kitchen\nwhere are you\nstop\nwhat do you see\n")
        assert pipe.stopped.wait(HUNG_S)
        pipe.end()
        assert pipe.stops == [("stop", 2)]
        assert pipe.rest() == ["what do you see"]
        assert pipe.lines.count == 4


def test_a_stop_that_comes_later_forgets_what_waits_from_before():
    with a_pipe() as pipe:
        pipe.lines.start()
        pipe.write("go to the kitchen\nwhere are you\n")
        assert pipe.lines.take(lambda *_: None) == "go to the kitchen"
        pipe.write("stop\n")
        assert pipe.stopped.wait(HUNG_S)
        pipe.end()
        assert pipe.stops == [("stop", 1)]
        assert pipe.rest() == []


def test_what_was_written_before_somebody_elses_stop_is_older_than_it_and_what_comes_after_is_not():
    with a_pipe() as pipe:
        taken = []
        pipe.lines.start()
        pipe.write("go to the kitchen\nwhere are you\n")
        pipe.lines.take(lambda *line: taken.append(line))
        pipe.is_stopped_elsewhere()
        pipe.write("what do you see\n")
        for _ in range(2):
            pipe.lines.take(lambda *line: taken.append(line))

    outdated = [bool(pipe.interlock.outdated(mark)) for _, mark in taken]
    assert outdated == [True, True, False]


def test_what_waits_behind_a_line_that_stops_comes_after_that_stop():
    with a_pipe() as pipe:
        taken = []
        pipe.lines.start()
        pipe.write("wait here\nwhere are you\n")
        pipe.lines.take(lambda *line: taken.append(line))
        with pipe.interlock.stopping(because("called_off")):
            """As `/restart` does, on this thread."""
        pipe.lines.take(lambda *line: taken.append(line))

    assert [bool(pipe.interlock.outdated(mark)) for _, mark in taken] == [True, False]


def test_what_lies_in_the_pipe_when_somebody_else_stops_is_older_than_the_stop():
    with a_pipe() as pipe:
        pipe.write("go to the kitchen\n")
        pipe.is_stopped_elsewhere()
        pipe.lines.start()
        taken = []
        pipe.lines.take(lambda _, mark: taken.append(mark))

    assert pipe.interlock.outdated(taken[0])


def test_of_two_stops_the_last_one_counts_for_what_is_before_it():
    with a_pipe() as pipe:
        pipe.write("one\nstop\ntwo\nstop\nthree\n")
        pipe.end()
        pipe.lines.start()
        assert pipe.rest() == ["three"]
        assert pipe.stops == [("stop", 3)]


def test_no_stop_comes_between_a_line_and_its_beginning():
    with a_pipe() as pipe:
        pipe.lines.start()
        pipe.write("go to the kitchen\n")

        def begin(*_):
            pipe.write("stop\n")
            assert not pipe.stopped.wait(0.05)

        assert pipe.lines.take(begin) == "go to the kitchen"
        assert pipe.stopped.wait(HUNG_S)


def test_it_can_be_closed_while_it_waits_for_a_line():
    with a_pipe() as pipe:
        pipe.lines.start()
        pipe.write("half a li")


def test_it_can_be_closed_while_too_much_waits():
    with a_pipe() as pipe:
        pipe.lines.start()
        line = "a" * 4095 + "\n"
        for _ in range(MAX_AHEAD_BYTES // 4095 + 1):
            pipe.write(line)
        assert pipe.lines.take(lambda *_: None) == line[:-1]


def test_a_last_line_needs_no_end():
    with a_pipe() as pipe:
        pipe.write("one\r\ntwo")
        pipe.end()
        pipe.lines.start()
        assert pipe.rest() == ["one", "two"]


@given(st.lists(st.binary(max_size=20).filter(lambda line: b"\n" not in line)), st.data())
def test_lines_are_the_same_however_they_arrive(lines, data):
    sent = b"\n".join([*lines, b""])
    splitter, found = Splitter(), []
    while sent:
        size = data.draw(st.integers(1, len(sent)))
        found += splitter.add(sent[:size])
        sent = sent[size:]
    found += splitter.add(b"")
    assert found == [line.decode(errors="replace").rstrip("\r") for line in lines]


def test_a_line_without_an_end_is_cut():
    splitter = Splitter()
    assert [len(line) for line in splitter.add(b"a" * (MAX_LINE_BYTES + 5))] == [MAX_LINE_BYTES]
    assert splitter.add(b"") == ["aaaaa"]


@pytest.mark.parametrize(
    ("typed", "done"),
    [
        ("go to the kitchen\nwhere are you\n", ["go to the kitchen", "where are you"]),
        ("go to the kitchen\nstop\n", ["stop"]),
        ("go to the kitchen\nstop\nwhere are you\n", ["stop", "where are you"]),
        ("", []),
    ],
)
def test_what_was_typed_before_the_prompt_begins_with_its_last_stop(typed, done):
    reading, writing = os.pipe()
    try:
        os.write(writing, typed.encode())
        assert typed_ahead(reading, is_stop) == done
    finally:
        os.close(reading)
        os.close(writing)
