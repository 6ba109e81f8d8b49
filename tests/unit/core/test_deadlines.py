"""What is to be done when time has run out, unless it was called off."""

import threading

import pytest

from edgevox.core.motion.deadlines import Deadlines


@pytest.fixture
def hold(deadlines):
    """Keeps its thread busy until it is told to go on."""
    held, go_on = threading.Event(), threading.Event()

    def busy():
        held.set()
        assert go_on.wait(60)

    deadlines.set(0.0, busy)
    assert held.wait(60)
    yield go_on.set
    go_on.set()


@pytest.fixture
def deadlines():
    one = Deadlines("deadlines")
    one.start()
    yield one
    one.close()
    assert not [t for t in threading.enumerate() if t.name == "deadlines"]


def test_what_is_due_is_done(deadlines):
    done = threading.Event()
    deadlines.set(0.0, done.set)
    assert done.wait(60)


def test_what_was_called_off_and_what_is_not_due_are_not_done(deadlines, hold):
    done, last = [], threading.Event()
    deadlines.set(3600.0, lambda: done.append("later"))
    call_off = deadlines.set(0.0, lambda: done.append("called off"))
    call_off()
    call_off()
    deadlines.set(0.001, last.set)
    hold()
    assert last.wait(60)
    assert done == []


def test_they_are_done_in_the_order_in_which_they_are_due(deadlines, hold):
    done, last = [], threading.Event()
    deadlines.set(0.2, last.set)
    deadlines.set(0.1, lambda: done.append("second"))
    deadlines.set(0.0, lambda: done.append("first"))
    hold()
    assert last.wait(60)
    assert done == ["first", "second"]


@pytest.mark.parametrize("seconds", [0.05, 3600.0])
def test_one_that_was_called_off_keeps_no_later_one_from_being_done(deadlines, seconds):
    done = threading.Event()
    call_off = deadlines.set(seconds, lambda: None)
    call_off()
    deadlines.set(0.1, done.set)
    assert done.wait(60)


def test_one_that_fails_keeps_no_other_from_being_done(deadlines):
    done = threading.Event()
    deadlines.set(0.0, lambda: {}["nothing"])
    deadlines.set(0.0, done.set)
    assert done.wait(60)


def test_closed_it_does_nothing_more():
    done = []
    one = Deadlines("closed")
    one.start()
    one.close()
    one.set(0.0, lambda: done.append("late"))
    assert done == []
