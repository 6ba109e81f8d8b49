"""A process that is asked to end halts its robot first, whatever hangs in it."""

import signal
import subprocess
import sys

import pytest
from guards import HUNG_S

from edgevox.apps.run_program import STUCK

PROGRAM = """
import os, sys, threading, time
from contextlib import ExitStack
from edgevox.agent.text.reasons import because
from edgevox.apps.run_program import ShutdownSignals, Terminated
from edgevox.core.agent_events import DrainChanged
from edgevox.core.bus import Bus
from edgevox.core.motion.drain import Drain
from edgevox.core.motion.interlock import Interlock

def say(word): os.write(1, (word + "\\n").encode())  # at once: threads say it, too
def hang(*_): threading.Event().wait()
what = sys.argv[1]
interlock = Interlock()
if what == "interlock":
    interlock.on_engage(hang)
bus = Bus()
bus.subscribe(DrainChanged, lambda _: os.write(2, b"drains\\n"))
drain = Drain(
    interlock, bus, halt=lambda _: say("halt"), stands=lambda: True, busy=lambda: what == "goal",
    reason=because("draining"), bound_s=0.2 if what != "goal" else 600.0, stand_s=0.2,
)
if what == "thread":
    threading.Thread(target=hang, name="stuck").start()
with ShutdownSignals(1.0 if what == "thread" else 10.0, drain) as signals:
    try:
        say("ready")  # a signal may come as soon as somebody has read this
        while True:
            time.sleep(1.0)
    except Terminated:
        pass
    finally:
        say("unwinding")
        drain.stand()
        if what == "closing":
            hang()
say("closed")
"""


def run(what, *signals):
    """What it says until it ends, its exit code, and what it says besides."""
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, what],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert program.stdout.readline() == "ready\n"
    for number, after in zip(signals, [*signals[1:], None], strict=True):
        program.send_signal(number)
        assert not after or "drains\n" in program.stderr  # two at the same time are one
    said, besides = program.communicate(timeout=HUNG_S)
    return said.split(), program.returncode, besides


def test_it_halts_before_it_unwinds():
    said, code, _ = run("nothing", signal.SIGTERM)
    assert said[0] == "halt"
    assert (said[-1], code) == ("closed", 0)


def test_what_hangs_while_it_closes_finds_the_robot_halted_and_is_left_behind():
    said, code, _ = run("closing", signal.SIGTERM)
    assert said.index("halt") < said.index("unwinding")
    assert (said[-1], code) == ("halt", STUCK), "once more, last of all"


def test_a_thread_that_does_not_end_is_left_behind_and_named():
    _, code, besides = run("thread", signal.SIGTERM)
    assert code == STUCK
    assert "leaving without what does not end: MainThread, stuck" in besides


def test_where_even_the_interlock_hangs_the_body_is_halted_before_the_end():
    said, code, _ = run("interlock", signal.SIGTERM)
    assert (said, code) == (["unwinding", "halt", "closed"], 0)


@pytest.mark.parametrize("second", [signal.SIGTERM, signal.SIGHUP])
def test_a_second_signal_ends_it_while_a_goal_still_runs(second):
    said, code, _ = run("goal", signal.SIGTERM, second)
    assert (said, code) == (["unwinding", "halt", "closed"], 0)


def test_who_hangs_up_does_not_wait_for_a_goal():
    said, code, _ = run("goal", signal.SIGHUP)
    assert (said, code) == (["unwinding", "halt", "closed"], 0)
