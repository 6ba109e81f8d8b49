"""The judge sees only what it is shown, and judges by the robot's time."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.scenario.format import MISSING, Compare, Condition, Never, look_up
from edgevox.scenario.judge import Judge, Seen, Source


def state(time_s, **data):
    return Seen(time_s, Source.STATE, data)


def answer(time_s, text):
    return Seen(time_s, Source.ANSWER, text)


def event(time_s, **data):
    return Seen(time_s, Source.EVENT, data)


IN_KITCHEN = Condition(state={"room": "kitchen"})


@pytest.mark.parametrize(
    ("wanted", "right", "wrong"),
    [
        ({"equals": None}, [None], [0, False, "", MISSING]),
        ({"equals": "red"}, ["red"], ["Red", "reddish", None]),
        ({"differs": 0}, [1, None, "0"], [0, 0.0]),
        ({"near": 1, "by": 0.1}, [1, 0.9, 1.1], [0.89, math.nan, "1", True, None]),
        ({"near": [1, 2], "by": 0.5}, [[1.2, 1.8], (1, 2)], [[1, 2, 3], [1], 1, [1, "2"]]),
        ({"above": 1}, [1.1, math.inf], [1, "2", None, True, MISSING]),
        ({"below": 1}, [0.9], [1, "0", None, False]),
        ({"above": 1, "below": 2}, [1.5], [1, 2, 0, 3]),
        ({"contains": "Red"}, ["the red cube", ["Red"], {"Red": 1}], ["rd", [], None, 4]),
        ({"matches": r"^\d+ m$"}, ["12 m"], ["12 metres", 12, None]),
    ],
)
def test_a_comparison_holds_for_what_it_says_and_nothing_else(wanted, right, wrong):
    compare = Compare.model_validate(wanted)
    assert all(compare.holds(value) for value in right)
    assert not any(compare.holds(value) for value in wrong)


PLAIN = st.none() | st.booleans() | st.floats() | st.integers() | st.text()


@given(st.recursive(PLAIN, lambda more: st.lists(more) | st.dictionaries(st.text(), more)))
def test_no_value_breaks_a_comparison(value):
    for wanted in ({"near": 1, "by": 1}, {"near": [1], "by": 1}, {"above": 1}, {"contains": "a"}):
        assert Compare.model_validate(wanted).holds(value) in (True, False)


def test_a_path_leads_through_mappings_and_lists():
    data = {"cubes": [{"name": "red"}], "goal": None}
    assert look_up("cubes.0.name", data) == "red"
    assert look_up("goal", data) is None
    for nowhere in ("cubes.1", "cubes.red", "goal.x", "cubes.0.name.0", ""):
        assert look_up(nowhere, data) is MISSING


def test_a_state_that_comes_in_time_is_what_was_expected():
    judge = Judge()
    watch = judge.expect(IN_KITCHEN, now_s=10.0, within_s=5.0)
    judge.see(state(12.0, room="hall"))
    assert not watch.met
    judge.see(state(15.0, room="kitchen"))
    assert watch.met


def test_a_state_that_comes_too_late_is_not():
    judge = Judge()
    watch = judge.expect(IN_KITCHEN, now_s=10.0, within_s=5.0)
    judge.see(state(14.9, room="hall"))
    judge.see(state(15.1, room="kitchen"))
    assert not watch.met
    assert watch.explain() == [
        "expected room = 'kitchen'",
        "last seen: room = 'hall', at 14.90 s",
    ]


def test_the_state_as_it_is_counts_at_once():
    judge = Judge()
    judge.see(state(3.0, room="kitchen"))
    assert judge.expect(IN_KITCHEN, now_s=3.0, within_s=0.0).met


def test_values_of_the_state_must_be_true_at_one_moment():
    judge = Judge()
    wanted = Condition(state={"room": "kitchen", "goal": None})
    watch = judge.expect(wanted, now_s=0.0, within_s=9.0)
    judge.see(state(1.0, room="kitchen", goal=1))
    judge.see(state(2.0, room="hall", goal=None))
    assert not watch.met
    judge.see(state(3.0, room="kitchen", goal=None))
    assert watch.met


def test_what_was_answered_and_done_since_the_last_stimulus_counts_and_nothing_before():
    judge = Judge()
    wanted = Condition(answer="there", event={"status": "succeeded"})
    judge.see(answer(1.0, "I am there."))
    judge.see(event(1.0, status="succeeded"))
    assert judge.expect(wanted, now_s=2.0, within_s=0.0).met
    judge.stimulus()
    watch = judge.expect(wanted, now_s=2.0, within_s=9.0)
    assert not watch.met
    judge.see(answer(3.0, "I am THERE."))
    assert watch.explain() == [
        "expected answer with 'there', event with status = 'succeeded'",
        "last seen: no event",
    ]
    judge.see(event(4.0, status="succeeded"))
    assert watch.met


def test_one_event_must_have_all_values():
    judge = Judge()
    watch = judge.expect(Condition(event={"skill": "grasp", "status": "failed"}), 0.0, 9.0)
    judge.see(event(1.0, skill="grasp", status="running"))
    judge.see(event(2.0, skill="place", status="failed"))
    assert not watch.met
    assert (
        watch.explain()[1] == "last seen: event with skill = 'place', status = 'failed', at 2.00 s"
    )


def test_what_must_never_be_is_found_whenever_it_comes():
    judge = Judge([Never(state={"fallen": True}), Never(answer="broke")])
    judge.see(state(1.0, fallen=False))
    judge.see(answer(1.5, "All is well."))
    assert judge.broken is None
    judge.see(state(2.0, fallen=True))
    judge.see(state(3.0, fallen=False))
    never, seen = judge.broken
    assert str(never) == "fallen = True"
    assert seen.time_s == 2.0


def test_what_must_never_be_has_to_be_there_to_be_judged():
    judge = Judge([Never(state={"colisions": {"above": 0}})])
    judge.see(state(1.0, collisions=7))
    assert judge.never_looked == ("colisions",)
    judge.see(state(2.0, colisions=0))
    assert judge.never_looked == ()
