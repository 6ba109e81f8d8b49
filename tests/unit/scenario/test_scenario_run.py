"""How a scenario is played, in a harness where nothing happens but what the test wants."""

import pytest
from support.clock import HeldClock

from edgevox.agent.skills import SkillFailed
from edgevox.scenario.format import parse_scenario
from edgevox.scenario.judge import Seen, Source
from edgevox.scenario.run import MOMENT_S, STREAM_S, heading, line, run_scenario, summary


class HeldHarness:
    """Time passes when it is let; `plan` is what is seen when, in seconds."""

    def __init__(self, plan=()):
        self.time_s = 100.0  # a robot's time need not begin at 0
        self.done = []
        self._plan = sorted(plan, key=lambda one: one[0])

    def say(self, text, timeout_s):
        self.done.append(("say", text))

    def interrupt(self, timeout_s):
        self.done.append(("interrupt",))

    def run(self, skill, arguments):
        if skill == "fly":
            raise SkillFailed("I have no wings.")
        self.done.append((skill, dict(arguments)))

    def steer(self, linear_m_s, angular_rad_s):
        self.done.append((round(self.time_s - 100.0, 6), linear_m_s, angular_rad_s))

    def let_pass(self, seconds):
        self.time_s += seconds
        return self.look()

    def look(self):
        seen = []
        while self._plan and self._plan[0][0] <= self.time_s - 100.0 + 1e-9:
            after_s, source, data = self._plan.pop(0)
            seen.append(Seen(100.0 + after_s, source, data))
        return [*seen, Seen(self.time_s, Source.STATE, {"time": round(self.time_s, 6)})]


def play(text, harness, clock=None):
    outcomes = []
    passed = run_scenario(
        parse_scenario(text, "s.yaml"), harness, outcomes.append, clock or HeldClock()
    )
    assert passed == outcomes[-1].passed
    return outcomes


def test_stimuli_are_given_in_order_and_take_no_time():
    harness = HeldHarness()
    outcomes = play(
        "steps: [{say: hello}, {run: grasp, with: {object: cube}}, {interrupt: true}]", harness
    )
    assert harness.done == [("say", "hello"), ("grasp", {"object": "cube"}), ("interrupt",)]
    assert [(one.passed, one.time_s) for one in outcomes] == [(True, 0.0)] * 3


def test_a_wait_lets_exactly_that_much_time_pass():
    (waited, _) = play("steps: [{wait: 1.23}, {wait: 0}]", HeldHarness())
    assert waited.time_s == pytest.approx(1.23)


def test_an_expectation_ends_as_soon_as_it_is_met():
    harness = HeldHarness([(2.0, Source.ANSWER, "I am there.")])
    (outcome,) = play("steps: [{expect: {answer: there}, within: 60}]", harness)
    assert outcome.passed
    assert outcome.time_s == pytest.approx(2.0, abs=MOMENT_S)


def test_an_expectation_that_is_not_met_ends_at_its_deadline_and_nothing_comes_after_it():
    harness = HeldHarness([(3.1, Source.ANSWER, "I am there.")])
    (outcome,) = play("steps: [{expect: {answer: there}, within: 3}, {say: more}]", harness)
    assert not outcome.passed
    assert outcome.time_s == pytest.approx(3.0)
    assert outcome.why == ("expected answer with 'there'", "last seen: no answer")
    assert harness.done == []


def test_a_velocity_is_sent_as_a_stream_for_as_long_as_it_should():
    harness = HeldHarness()
    (outcome,) = play("steps: [{drive: {linear: 0.3, seconds: 0.5}}]", harness)
    assert [time_s for time_s, *_ in harness.done] == pytest.approx(
        [STREAM_S * number for number in range(5)]
    )
    assert outcome.time_s == pytest.approx(0.5)


def test_what_a_stimulus_did_is_not_counted_for_the_next():
    harness = HeldHarness([(0.5, Source.ANSWER, "Yes.")])
    outcomes = play(
        "steps: [{say: one}, {wait: 1}, {say: two}, {expect: {answer: 'yes'}, within: 1}]", harness
    )
    assert [one.passed for one in outcomes] == [True, True, True, False]


def test_what_must_never_be_ends_the_step_in_which_it_comes():
    harness = HeldHarness([(1.0, Source.EVENT, {"status": "failed"})])
    (outcome,) = play("never: [{event: {status: failed}}]\nsteps: [{wait: 9}, {wait: 9}]", harness)
    assert outcome.why == (
        "expected never event with status = 'failed'",
        "seen: event with status = 'failed', at 101.00 s",
    )
    assert outcome.time_s == pytest.approx(1.0, abs=MOMENT_S)


def test_a_never_about_a_value_that_there_is_not_fails_at_the_end():
    (outcome,) = play("never: [{state: {tmie: 1}}]\nsteps: [{wait: 1}]", HeldHarness())
    assert outcome.why == ("never could not be judged: robot_state has no tmie",)


def test_a_refused_skill_fails_with_its_reason():
    (outcome,) = play("steps: [{run: fly}]", HeldHarness())
    assert outcome.why == ("I have no wings.",)


def test_real_time_has_its_limit():
    (outcome,) = play("limit_s: 5\nsteps: [{wait: 3600}]", HeldHarness(), HeldClock(look_s=0.1))
    assert outcome.why == ("it took longer than the limit of 5 real s",)
    assert outcome.time_s < 10


def test_the_report_says_what_was_done_when_and_why_it_failed():
    scenario = parse_scenario("about: a wait\nsteps: [{wait: 2}, {expect: {answer: x}}]", "s.yaml")
    outcomes = []
    run_scenario(scenario, HeldHarness(), outcomes.append, HeldClock())
    assert heading(scenario, "s.yaml", "robot-x") == "s.yaml on robot-x: a wait"
    assert line(outcomes[0]) == "PASS   1      2.00 s     0.00 s real  wait 2 s"
    assert line(outcomes[1]).splitlines()[1].strip() == "expected answer with 'x'"
    assert summary(scenario, outcomes[1]) == "FAILED at step 2 of 2"
