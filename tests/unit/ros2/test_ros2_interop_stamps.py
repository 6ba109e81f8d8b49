"""The body's time on another clock."""

import itertools
from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from edgevox.ros2.stamps import LAG_NS, NS_PER_S, WINDOW_NS, Stamps, TimeOffset, to_msg, to_ns

MS = 1_000_000
EPOCH = 1_790_000_000 * NS_PER_S


class FakeClock:
    def __init__(self, *, simulated=False):
        self.ns = EPOCH
        self.ros_time_is_active = simulated

    def now(self):
        return SimpleNamespace(nanoseconds=self.ns)


def run(pairs):
    offset = TimeOffset()
    stamps = []
    for body_ns, now_ns in pairs:
        offset.align(body_ns, now_ns)
        stamps.append(offset.lay(body_ns))
    return stamps


@given(st.lists(st.tuples(st.integers(0, 200 * MS), st.integers(1, 200 * MS)), max_size=200))
def test_stamps_never_go_back_and_are_never_in_the_future(steps):
    body_ns, now_ns, pairs = 0, EPOCH, []
    for body_step_ns, step_ns in steps:
        body_ns, now_ns = body_ns + body_step_ns, now_ns + step_ns
        pairs.append((body_ns, now_ns))
    stamps = run(pairs)
    assert stamps == sorted(stamps)
    assert all(stamp <= now for stamp, (_, now) in zip(stamps, pairs, strict=True))


def test_a_body_that_is_looked_at_late_keeps_its_own_even_spacing():
    late_ms = [0, 3, 19, 0, 30, 12, 45, 0, 7, 1]
    pairs = [(n * 20 * MS, EPOCH + (n * 20 + ms) * MS) for n, ms in enumerate(late_ms * 20)]
    stamps = run(pairs)
    assert {b - a for a, b in itertools.pairwise(stamps)} == {20 * MS}


def test_time_that_the_body_lost_for_good_is_given_up_within_two_windows():
    lost = 300 * MS
    pairs = [(n * 20 * MS, EPOCH + n * 20 * MS + lost * (n > 50)) for n in range(200)]
    stamps = run(pairs)
    assert pairs[-1][1] - stamps[-1] <= LAG_NS
    recovered = next(n for n in range(51, 200) if pairs[n][1] - stamps[n] <= LAG_NS)
    assert (recovered - 51) * 20 * MS <= 2 * WINDOW_NS


def test_a_body_whose_time_starts_again_is_stamped_on():
    stamps = run([(5 * NS_PER_S, EPOCH), (0, EPOCH + 20 * MS), (20 * MS, EPOCH + 40 * MS)])
    assert stamps == [EPOCH, EPOCH + 20 * MS, EPOCH + 40 * MS]


def test_a_clock_that_is_set_is_followed():
    day = 86_400 * NS_PER_S
    assert run([(0, EPOCH), (MS, EPOCH + day)])[-1] == EPOCH + day
    assert run([(0, EPOCH), (MS, EPOCH - day)])[-1] == EPOCH - day


def test_what_is_older_than_now_is_stamped_as_old_as_it_is():
    clock = FakeClock()
    stamps = Stamps(clock, lambda: 10.0)
    assert stamps.nanoseconds(9.97) == EPOCH - 30 * MS


def test_with_sim_time_it_is_that_clock_less_the_age():
    clock = FakeClock(simulated=True)
    clock.ns = 7 * NS_PER_S
    assert Stamps(clock, lambda: 10.0).nanoseconds(9.5) == 6_500 * MS


def test_with_sim_time_and_no_clock_there_is_no_stamp():
    clock = FakeClock(simulated=True)
    clock.ns = 0
    assert Stamps(clock, lambda: 10.0).nanoseconds(10.0) is None


def test_with_a_clock_of_its_own_stamps_are_the_bodys_time():
    assert Stamps(FakeClock(), lambda: 10.0, own_clock=True).nanoseconds(1.25) == 1_250 * MS


@given(st.integers(0, 2**31 * NS_PER_S - 1))
def test_a_stamp_survives_the_wire(ns):
    assert to_ns(to_msg(ns)) == ns
