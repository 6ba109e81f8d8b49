"""What is counted of what happens on the bus, and what is read when somebody asks."""

import contextlib
import http.client
import socket
import threading
from collections.abc import Callable
from typing import Any, get_args

import pytest
from prometheus_client.parser import text_string_to_metric_families
from support.clock import HeldClock

from edgevox.core.agent_events import (
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    SafetyPreempted,
    ToolCalled,
)
from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.events import (
    Cause,
    Interrupted,
    Outcome,
    State,
    StateChanged,
    TokenGenerated,
    TurnEnded,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.core.status import Components, Status
from edgevox.ops.http_server import MOST_AT_ONCE
from edgevox.ops.metric_table import SKILLS
from edgevox.ops.metrics import MetricsServer, Registry, observe
from edgevox.ros2.node import LATELY_S, Heartbeat


class Rig:
    """A bus that is observed, and what a scrape says of it."""

    def __init__(self) -> None:
        self.bus, self.clock = Bus(), HeldClock()
        self.registry = Registry({SKILLS: ["navigate_to", "wave"]})
        self.end = observe(self.bus, self.registry, self.clock)

    def value(self, name: str, **labels: str) -> float | None:
        for family in text_string_to_metric_families(self.registry.text().decode()):
            for sample in family.samples:
                if sample.name == name and sample.labels == labels:
                    return sample.value
        return None

    def goal(self, goal_id: str, status: str, skill: str = "navigate_to") -> None:
        if status == GoalStatus.CANCELLED:
            self.bus.publish(GoalCancelled(goal_id, skill, {}, 0, "enough"))
        else:
            self.bus.publish(GoalChanged(goal_id, skill, {}, GoalStatus(status), 0))


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_turns_count_by_what_became_of_them_and_those_without_words_do_not(rig) -> None:
    for outcome in (Outcome.ACTED, Outcome.ACTED, Outcome.REFUSED, None):
        rig.bus.publish(TurnEnded(1, outcome, 5))

    assert rig.value("edgevox_turns_total", outcome="acted") == 2
    assert rig.value("edgevox_turns_total", outcome="refused") == 1
    assert rig.value("edgevox_turns_total", outcome="failed") == 0
    assert rig.value("edgevox_llm_tokens_total") == 20


def test_a_stage_that_a_turn_did_not_need_is_not_in_its_histogram(rig) -> None:
    rig.bus.publish(TurnMeasured(stt=0.0, llm=0.9, tts=0.0, ttfs=1.2, total=2.5))

    assert rig.value("edgevox_turn_stage_seconds_count", stage="stt") == 0
    assert rig.value("edgevox_turn_stage_seconds_sum", stage="llm") == 0.9
    assert rig.value("edgevox_turn_stage_seconds_bucket", stage="ttfs", le="1.0") == 0
    assert rig.value("edgevox_turn_stage_seconds_bucket", stage="ttfs", le="1.5") == 1


def test_a_goal_runs_from_its_first_sign_to_its_end_whatever_it_reports_meanwhile(rig) -> None:
    rig.goal("a", "accepted")
    rig.goal("a", "running")
    rig.clock.now_s = 3.0
    rig.goal("a", "running")
    assert rig.value("edgevox_skill_goals_running", skill="navigate_to") == 1

    rig.clock.now_s = 7.0
    rig.goal("a", "succeeded")
    assert rig.value("edgevox_skill_goals_running", skill="navigate_to") == 0
    assert rig.value("edgevox_skill_goal_seconds_sum", skill="navigate_to") == 7.0
    assert rig.value("edgevox_skill_goals_total", skill="navigate_to", outcome="succeeded") == 1


def test_a_goal_that_never_ran_took_no_time(rig) -> None:
    rig.goal("b", "accepted", "wave")
    rig.goal("b", "cancelled", "wave")

    assert rig.value("edgevox_skill_goals_total", skill="wave", outcome="cancelled") == 1
    assert rig.value("edgevox_skill_goal_seconds_count", skill="wave") == 0
    assert rig.value("edgevox_skill_goals_running", skill="wave") == 0


def test_who_interrupts_is_counted_and_a_stop_word_twice_if_it_stopped_something(rig) -> None:
    rig.bus.publish(Interrupted(Cause.BARGE_IN))
    for stopped in (True, False):
        rig.bus.publish(SafetyPreempted("halt", stopped))

    assert rig.value("edgevox_interrupts_total", cause="barge_in") == 1
    assert rig.value("edgevox_interrupts_total", cause="stop_word") == 2
    assert rig.value("edgevox_safety_stops_total") == 1


def test_one_state_is_the_present_one(rig) -> None:
    rig.bus.publish(StateChanged(State.LISTENING))
    rig.bus.publish(StateChanged(State.THINKING))

    assert rig.value("edgevox_state", state="thinking") == 1
    assert rig.value("edgevox_state", state="listening") == 0


def test_wake_words_and_who_called_are_counted(rig) -> None:
    rig.bus.publish(WakeWordHeard("hey jarvis"))
    rig.bus.publish(ToolCalled("navigate_to", {}, "reading", 1))

    assert rig.value("edgevox_wake_words_total") == 1
    assert rig.value("edgevox_skill_calls_total", source="reading") == 1


class AskedOf(Bus):
    """A bus that remembers what anybody listens for."""

    def __init__(self) -> None:
        super().__init__()
        self.kinds: set[type] = set()

    def subscribe(self, kind: Any, handler: Any) -> Callable[[], None]:
        self.kinds.update(get_args(kind) or (kind,))
        return super().subscribe(kind, handler)


def test_a_token_is_nobodys_business_until_its_turn_ends(rig) -> None:
    bus = AskedOf()
    observe(bus, rig.registry, rig.clock)

    assert TurnEnded in bus.kinds
    assert TokenGenerated not in bus.kinds


def test_nothing_is_counted_after_the_end(rig) -> None:
    rig.end()
    rig.bus.publish(TurnEnded(1, Outcome.ACTED))

    assert rig.value("edgevox_turns_total", outcome="acted") == 0


def test_what_is_read_is_read_anew_and_one_that_breaks_takes_no_other_with_it(rig) -> None:
    counts = {"speech_output": 1}
    rig.registry.read("edgevox_dropped_total", lambda: counts)
    rig.registry.read("edgevox_threads", lambda: 1 / 0)
    rig.registry.read("edgevox_build_info", lambda: {("0.1", "robot", "fr"): 1.0})
    assert rig.value("edgevox_dropped_total", queue="speech_output") == 1

    counts["speech_output"] = 4
    assert rig.value("edgevox_dropped_total", queue="speech_output") == 4
    assert rig.value("edgevox_threads") is None
    assert rig.value("edgevox_build_info", version="0.1", agent="robot", language="fr") == 1
    assert rig.registry.failures > 0


class Part:
    checks = ()

    def __init__(self, name, **values):
        self.name, self.values = name, values

    def status(self):
        if not self.values:
            raise ZeroDivisionError
        return Status.judged(self.name, **self.values)


def test_what_components_say_is_read_anew_and_one_that_breaks_takes_no_other_with_it(
    caplog,
) -> None:
    executor = Part("executor", lag_s=0.5, failed_callbacks=2)
    registry = Registry(None, Components(Part("sim"), executor))
    assert b"edgevox_executor_lag_seconds 0.5" in registry.text()
    assert [record.msg["component"] for record in caplog.records] == ["sim"]
    executor.values = {"lag_s": 1.5, "failed_callbacks": 2}
    text = registry.text()
    assert b"edgevox_executor_lag_seconds 1.5" in text
    assert b'edgevox_failures_total{part="executor"} 2.0' in text
    assert b"edgevox_sim_" not in text
    assert b'edgevox_failures_total{part="metrics"} 2.0' in text


def test_two_agents_in_one_process_count_apart() -> None:
    one, other = Rig(), Rig()
    one.bus.publish(TurnEnded(1, Outcome.ACTED))

    assert other.value("edgevox_turns_total", outcome="acted") == 0


def ask(server: MetricsServer, path: str = "/metrics") -> tuple[int, str, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    connection.request("GET", path)
    answer = connection.getresponse()
    told = answer.status, answer.headers["Content-Type"], answer.read()
    connection.close()
    return told


def test_metrics_are_served_as_prometheus_reads_them_until_close(rig) -> None:
    server = MetricsServer(rig.registry, "127.0.0.1", 0)
    server.start()
    status, kind, text = ask(server)
    assert (status, kind) == (200, "text/plain; version=0.0.4; charset=utf-8")
    assert b"# TYPE edgevox_turns_total counter" in text
    assert ask(server, "/")[0] == 404

    with pytest.raises(InvalidValue, match=rf"metrics_port: got '127.0.0.1:{server.port}'.*in use"):
        MetricsServer(rig.registry, "127.0.0.1", server.port)
    server.close()
    assert "edgevox-metrics" not in [thread.name for thread in threading.enumerate()]


def test_who_does_not_listen_to_the_answer_keeps_nobody_from_theirs(rig) -> None:
    server = MetricsServer(rig.registry, "127.0.0.1", 0)
    server.start()
    try:
        deaf = [
            socket.create_connection(("127.0.0.1", server.port)) for _ in range(MOST_AT_ONCE - 1)
        ]
        for one in deaf:
            one.sendall(b"GET /metrics HTTP/1.1\r\n")  # and never the rest
        assert ask(server)[0] == 200
        for one in deaf:
            one.settimeout(60)
            with one, contextlib.suppress(ConnectionResetError):
                assert one.recv(1) == b""
    finally:
        server.close()


def test_a_heart_that_was_late_once_says_so_for_a_minute() -> None:
    clock = HeldClock()
    heart = Heartbeat(clock, period_s=1.0)
    for now_s in (1.0, 2.7, 3.0, 4.0):
        clock.now_s = now_s
        heart.beat()
    assert heart.lag_s == pytest.approx(0.7)
    clock.now_s = 7.5
    assert heart.lag_s == pytest.approx(2.5), "a beat that is due counts before it comes"
    heart.begin()
    assert heart.lag_s == 0.0
    heart.beat()
    clock.now_s += LATELY_S
    heart.begin()
    assert heart.lag_s == 0.0
