"""The metrics of a real agent: what moves them, on a terminal and on ROS 2."""

import math
import socket
import subprocess
import sys
import threading
from pathlib import Path

import phrases
import pytest
from agent_process import AGENT, Agent
from geometry_msgs.msg import Twist
from guards import HUNG_S, run_program
from ports import free_port
from scraper import Scrape, scrape_until
from waiting import wait_until

from edgevox import __version__
from edgevox.ops.metric_table import METRICS

RECORDER = str(Path(sys.executable).with_name("edgevox-recorder"))
LAG_S = 30.0
"""Nothing on a machine that tests may share is as late as this."""


def twist(speed_m_s: float) -> Twist:
    message = Twist()
    message.linear.x = speed_m_s
    return message


@pytest.fixture(scope="module")
def port() -> int:
    return free_port()


@pytest.fixture(scope="module")
def resident(shared, port) -> Agent:
    return shared("--metrics-port", str(port))


@pytest.fixture
def before(port, robot) -> Scrape:
    """What has been counted by now."""
    return scrape_until(port, bool)


@pytest.mark.parametrize("topic", ["tts_request", "text_input"])
def test_what_is_too_long_is_answered_and_counted_by_its_reason(port, robot, before, topic) -> None:
    answers = robot.listen("response")
    robot.send(topic, "x" * 1_000_000)
    answers.wait_for(lambda m: m == phrases.said("too_long", length=1_000_000, limit=2000))
    too_long, too_many = (
        ("edgevox_refused_requests_total", one) for one in ("too_long", "too_many")
    )
    said = scrape_until(port, lambda s: s[too_long] == before[too_long] + 1)
    assert said[too_many] == 0


def test_what_happens_on_the_wire_is_counted(port, robot, before) -> None:
    drive = robot.node.create_publisher(Twist, "/edgevox/cmd_vel", 10)
    pause = threading.Event()
    wait_until(drive.get_subscription_count, "/edgevox/cmd_vel")

    robot.send("set_language", "klingon")
    robot.send("interrupt", "")
    refused = ("edgevox_refused_messages_total", "not_finite", "cmd_vel")

    def is_refused(said: Scrape) -> bool:
        # The robot may know the publisher later than that knows of the robot: the first is lost.
        drive.publish(twist(math.nan))
        return said[refused] > before[refused]

    scrape_until(port, is_refused)
    halts = ("edgevox_watchdog_halts_total",)

    def is_halted(said: Scrape) -> bool:
        # What goes on over the interrupt is void until a pause; in each the watchdog halts it.
        if said[halts] <= before[halts]:
            drive.publish(twist(0.3))
            pause.wait(1.0)
        return said[halts] > before[halts]

    said = scrape_until(port, is_halted)

    def more(*name: str) -> float:
        return said[name] - before[name]

    assert more("edgevox_refused_messages_total", "invalid", "set_language") == 1
    assert more("edgevox_refused_messages_total", "invalid", "text_input") == 0
    assert more("edgevox_refused_requests_total", "too_long") == 0
    assert more("edgevox_interrupts_total", "topic") == 1
    assert said["edgevox_check_ok", "ros2"] == 1
    assert said["edgevox_failures_total", "executor"] == 0
    assert 0 <= said["edgevox_executor_lag_seconds",] < LAG_S

    robot.send("set_language", "fr")
    scrape_until(
        port, lambda s: any(n[:3] == ("edgevox_build_info", "robot-apartment", "fr") for n in s)
    )
    robot.send("text_input", "va dans la cuisine")
    scrape_until(port, lambda s: s["edgevox_skill_goals_running", "navigate_to"] == 1)
    robot.send("interrupt", "")
    ended = scrape_until(port, lambda s: s["edgevox_skill_goals_running", "navigate_to"] == 0)
    cancelled = ("edgevox_skill_goals_total", "cancelled", "navigate_to")
    assert ended[cancelled] == before[cancelled] + 1
    robot.send("set_language", "en")


def test_a_recorder_counts_what_is_on_the_disk(resident, tmp_path) -> None:
    port = free_port()
    arguments = ("--output", str(tmp_path), "--metrics-port", str(port))
    recorder = Agent(*arguments, domain=resident.domain, program=RECORDER)
    try:
        told = scrape_until(port, lambda s: s.get(("edgevox_recorded_messages_total",), 0) > 5)
        assert told[("edgevox_dropped_total", "recorder")] == 0
        assert told[("edgevox_recordings_bytes",)] > 0
        assert told[("edgevox_recordings_free_bytes",)] > 0
        assert told[("edgevox_ready",)] == 1
        assert told[("edgevox_build_info", "edgevox-recorder", "en", __version__)] == 1
        assert not any(name[0].startswith("edgevox_turn") for name in told)
    finally:
        assert recorder.terminate() == 0


def test_a_typed_sentence_moves_the_counters_of_a_running_agent() -> None:
    port = free_port()
    command = [AGENT, "robot-apartment", "--text-mode", "--simple-ui", "--llm", "none"]
    process = subprocess.Popen(
        [*command, "--metrics-port", str(port)],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )
    try:
        before = scrape_until(port, lambda s: s[("edgevox_ready",)] == 1)
        assert before[("edgevox_turns_total", "acted")] == 0
        assert before[("edgevox_skill_goals_total", "succeeded", "navigate_to")] == 0

        print("go to the kitchen", file=process.stdin, flush=True)
        scrape_until(port, lambda s: s["edgevox_skill_goals_running", "navigate_to"] == 1)
        driven = scrape_until(
            port, lambda s: s["edgevox_skill_goals_total", "succeeded", "navigate_to"] == 1
        )
        assert driven[("edgevox_turns_total", "acted")] == 1
        assert driven[("edgevox_skill_calls_total", "template")] == 1
        assert driven[("edgevox_turn_stage_seconds_count", "ttfs")] == 1
        assert driven[("edgevox_turn_stage_seconds_count", "stt")] == 0
        assert 0 < driven[("edgevox_turn_stage_seconds_sum", "total")] < HUNG_S
        assert driven[("edgevox_skill_goals_running", "navigate_to")] == 0
        assert driven[("edgevox_skill_goal_seconds_sum", "navigate_to")] > 1

        print("go to the cellar", file=process.stdin, flush=True)
        scrape_until(port, lambda s: s["edgevox_turns_total", "refused"] == 1)
        print("stop", file=process.stdin, flush=True)
        stopped = scrape_until(port, lambda s: s["edgevox_interrupts_total", "stop_word"] == 1)
        assert stopped[("edgevox_safety_stops_total",)] == 0, "it stood already"

        paced = scrape_until(port, lambda s: s[("edgevox_sim_real_time_factor",)] > 0)
        assert paced[("edgevox_sim_stalled_seconds",)] < HUNG_S
        assert paced[("edgevox_build_info", "robot-apartment", "en", __version__)] == 1
        assert paced[("edgevox_threads",)] > 3
        assert paced[("edgevox_check_ok", "body")] == 1
        series = {name for metric in METRICS.values() for name in metric.series}
        assert {name[0] for name in paced} <= series
    finally:
        process.stdin.close()
        process.terminate()
        process.wait(HUNG_S)
    assert process.returncode == 0


def test_without_a_port_nothing_of_it_is_imported() -> None:
    code = (
        "import sys, edgevox.apps.agent.main, edgevox.apps.edgevox;"
        "sys.exit(any(m.partition('.')[0] == 'prometheus_client' for m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_a_port_that_is_taken_is_said_before_anything_is_loaded() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        ran = run_program([AGENT, "robot-apartment", "--text-mode", "--metrics-port", str(port)])
    assert ran.returncode == 2
    assert f"metrics_port: got '127.0.0.1:{port}'" in ran.stderr
    assert "loading" not in ran.stdout
