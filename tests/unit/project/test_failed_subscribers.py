"""The guard of all tests: what fails on a bus is found, in this process and in a program's log."""

import pytest
from failed_subscribers import assert_none_in

from edgevox.core.bus import Bus
from edgevox.core.events import Transcribed


def test_what_fails_is_taken_once_with_its_traceback(failed_subscribers):
    bus = Bus()

    def broken(event):
        raise KeyError("what_did_you_hear")

    bus.subscribe(Transcribed, broken)
    assert failed_subscribers.take() == ""
    bus.publish(Transcribed("hello"))
    taken = failed_subscribers.take()
    assert "in broken" in taken
    assert "what_did_you_hear" in taken
    assert failed_subscribers.take() == ""


def test_a_log_with_such_a_line_is_refused():
    assert_none_in("edgevox-agent is ready\nall is well")
    with pytest.raises(AssertionError, match="subscriber_failed on=GoalChanged"):
        assert_none_in("ready\nERROR edgevox.core.bus subscriber_failed on=GoalChanged")
