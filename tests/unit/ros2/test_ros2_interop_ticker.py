"""Something to do at a rate."""

import threading

from support.clock import HeldClock

from edgevox.ros2.ticker import Ticker


def test_a_tick_that_fails_is_counted_and_the_next_one_comes(caplog):
    ticks, enough = [], threading.Event()

    def tick():
        ticks.append(threading.current_thread().name)
        if len(ticks) == 5:
            enough.set()
        if len(ticks) < 5:
            raise RuntimeError("no")

    ticker = Ticker("metronome")
    ticker.every(0.001, tick)
    ticker.start()
    assert enough.wait(60)
    ticker.close()
    assert ticker.failures == 4
    assert set(ticks) == {"metronome"}
    assert len(caplog.records) == 3  # the 1st, 2nd and 4th


def run(jobs, until_s):
    """What `jobs`, a period to the seconds that its ticks take, do when, and how many wakings."""
    time, done, wakings = HeldClock(), [], 0
    ticker = Ticker("metronome", time)

    def job(period_s, takes_s):
        def tick():
            done.append((period_s, round(time.now_s, 3)))
            time.now_s += takes_s.pop(0) if takes_s else 0.0

        ticker.every(period_s, tick)

    for period_s, takes_s in jobs.items():
        job(period_s, list(takes_s))
    ticker.begin()
    while time.now_s <= until_s:
        wakings += 1
        time.now_s += ticker.tick()
    return done, wakings


def test_ticks_are_due_at_multiples_of_the_period_and_missed_ones_are_skipped():
    done, _ = run({1.0: [0.4, 2.2]}, until_s=4.0)
    assert done == [(1.0, 0.0), (1.0, 1.0), (1.0, 4.0)]


def test_what_is_due_together_is_done_in_one_waking():
    done, wakings = run({1 / 30: [], 0.1: []}, until_s=0.99)
    assert len([one for one in done if one[0] == 0.1]) == 10
    assert len([one for one in done if one[0] == 1 / 30]) == 30
    assert wakings == 30


def test_a_job_that_is_ended_is_not_done_again_and_the_others_are():
    ticks, enough = {"one": 0, "other": 0}, threading.Event()
    ticker = Ticker("metronome")

    def other():
        ticks["other"] += 1
        if ticks["other"] == 3:
            end_one()
            ticks["at the end"] = ticks["one"]
        if ticks["other"] == 10:
            enough.set()

    end_one = ticker.every(0.001, lambda: ticks.update(one=ticks["one"] + 1))
    ticker.every(0.001, other)
    ticker.start()
    assert enough.wait(60)
    ticker.close()
    assert ticks["one"] == ticks["at the end"]


def test_a_job_is_over_when_its_end_returns():
    inside, leave, over = threading.Event(), threading.Event(), threading.Event()
    ticker = Ticker("metronome")

    def tick():
        inside.set()
        leave.wait(60)

    end = ticker.every(0.001, tick)
    ticker.start()
    assert inside.wait(60)
    ending = threading.Thread(target=lambda: (end(), over.set()))
    ending.start()
    assert not over.wait(0.05)
    leave.set()
    assert over.wait(60)
    ending.join()
    ticker.close()


def test_it_can_be_closed_before_it_was_started_and_without_anything_to_do():
    ticker = Ticker("metronome")
    ticker.close()
    idle = Ticker("metronome")
    idle.start()
    idle.close()
