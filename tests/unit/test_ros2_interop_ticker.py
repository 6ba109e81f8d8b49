"""Something to do at a rate."""

import threading

from edgevox.ros2.ticker import Ticker


def test_a_tick_that_fails_is_counted_and_the_next_one_comes(caplog):
    ticks, enough = [], threading.Event()

    def tick():
        ticks.append(threading.current_thread().name)
        if len(ticks) == 5:
            enough.set()
        if len(ticks) < 5:
            raise RuntimeError("no")

    ticker = Ticker(tick, 0.001, "metronome")
    ticker.start()
    assert enough.wait(10)
    ticker.close()
    assert ticker.failures == 4
    assert set(ticks) == {"metronome"}
    assert len(caplog.records) == 3  # the 1st, 2nd and 4th


class FakeClock:
    """Reads the times that it was given; the last one stays."""

    def __init__(self, *times_s):
        self._times_s = list(times_s)

    def now(self):
        return self._times_s.pop(0) if len(self._times_s) > 1 else self._times_s[0]


class FakeEvent:
    """Notes how long it was waited for; the third wait is the end."""

    def __init__(self):
        self.waits = []

    def wait(self, seconds):
        self.waits.append(seconds)
        return len(self.waits) == 3


def test_ticks_are_due_at_multiples_of_the_period_and_missed_ones_are_skipped():
    # started at 10.0; the first tick ends at 10.4, the second, due at 11.0, only at 13.2
    clock = FakeClock(10.0, 10.0, 10.4, 10.4, 13.2, 13.2)
    ticker = Ticker(lambda: None, 1.0, "metronome", clock)
    ticker._closing = waiting = FakeEvent()
    ticker._work()
    assert [round(one, 6) for one in waiting.waits] == [0.0, 0.6, 0.8]


def test_it_can_be_closed_before_it_was_started():
    Ticker(lambda: None, 1.0, "metronome").close()
