"""Five minutes of random faults and random input; then the node does all that it did before.

Each run throws the same dice, so that what CI says of a change is about the change; another
EDGEVOX_CHAOS_SEED throws others. EDGEVOX_CHAOS_S is how long it lasts: less than 300 s shows less.
"""

import itertools
import os
import random
import re
import socket
import sys
import time
from collections import Counter, deque
from dataclasses import asdict

import pytest
from agent_process import READY, Agent
from chaos_actions import Actions
from chaos_machine import busy_cores, told
from chaos_robot import ARRIVE_S, THINK_S, Robot
from chaos_world import Killed, ModelFiles, ModelServer
from lease import LEASE_S
from waiting import wait_until

from edgevox.agent.llm.xllamacpp_model import KEPT_PROMPTS_MIB

CHAOS_S = float(os.environ.get("EDGEVOX_CHAOS_S", "300"))
SEED = int(os.environ.get("EDGEVOX_CHAOS_SEED", "5"))
WARM_UP_S = min(60.0, CHAOS_S / 3)
"""Until then caches fill: each language, voice and way to fail was there once."""
PROBE_EVERY_S = 20.0
PAUSE_S = 0.5
MARGIN_MB = 40 + KEPT_PROMPTS_MIB
"""What may be more at the end. The model keeps other chats, up to that, to go on with: it talked in
three languages. Its context, of which 4,096 tokens take 50 MB, fills as a chat gets longer, and the
allocator keeps some. `models/test_llm_memory.py` looks at the model alone, more closely."""
LATE = {"threads": 2, "files": 0}
"""What may be more at the end. OpenMP starts a helper for each thread when that first computes in
parallel, and the one that rates unsure words may do so late: it waits for words that are unsure."""
FORGOTTEN_S, GIVEN_UP_S = LEASE_S + 4.0, 60.0
"""The middleware gives a killed peer up after its lease, on a busy machine a little later."""
SLOWER, SLACK_S = 3.0, 2.0
"""How much longer something may take than in the first minute, on a machine that others share."""
LONGEST_S = {"drive": ARRIVE_S, "model": THINK_S}
"""A way may be longer, and a model that spoke another language last reads its instructions anew."""
TAIL = 60


def say(text):
    sys.stdout.write(f"{text}\n")


class Journal:
    """What was done, for whoever has to find out why it failed."""

    def __init__(self, robot, file, machine):
        self._robot, self._file, self.machine = robot, file, machine
        self._begun_s = time.monotonic()
        self.counts = Counter()
        self.memory_mb = []
        self.last = deque(maxlen=50)

    def note(self, name, what):
        self.counts[name] += 1
        self.last.append(f"{time.monotonic() - self._begun_s:7.2f} s  {name}: {what}")

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is None:
            return
        say(f"EDGEVOX_CHAOS_SEED={SEED}; the last of {self.counts.total()} actions:")
        say("\n".join(self.last))
        say(f"the machine: {self.machine}")
        say(f"the node: {self._robot.how_it_is()}")
        self._file.write_text(self._robot.agent.output)
        say(f"the end of its log, which is whole in {self._file}:")
        say("\n".join(self._robot.agent.lines[-TAIL:]))


@pytest.fixture
def machine():
    return told(busy_cores())


@pytest.fixture
def server():
    one = ModelServer()
    yield one
    one.die()


@pytest.fixture
def killed(domain):
    one = Killed(domain)
    yield one
    one.close()


@pytest.fixture
def robot(domain, peer, server, tmp_path, monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as free:
        health_port = free.getsockname()[1]
    files = ModelFiles(tmp_path / "models")
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(files.root))
    agent = Agent(
        *("robot-apartment", "--simple-ui", "--no-render", "--ros2"),
        *("--audio-in", "ros2", "--audio-out", "ros2", "--health-port", str(health_port)),
        *("--llm-endpoint", f"http://127.0.0.1:{server.port}", "--llm-endpoint-timeout", "2"),
        domain=domain,
    )
    try:
        agent.wait_for_line(READY, 180.0)
        one = Robot(agent, peer(), health_port)
        one.files = files
        yield one
    finally:
        agent.terminate()


def run_chaos(actions, robot, killed, rng, journal, seconds):
    """Do random things for so long; the times that it took to stand, in between."""
    weighed = actions.weighed()
    doable, weights = list(weighed), list(weighed.values())
    stops, probe_s = [], time.monotonic() + PROBE_EVERY_S
    until_s = time.monotonic() + seconds
    while time.monotonic() < until_s:
        action = rng.choices(doable, weights)[0]
        journal.note(action.__name__, "...")
        what = action()
        journal.last[-1] = journal.last[-1].removesuffix("...") + what
        killed.look()
        robot.check_alive()
        time.sleep(rng.uniform(0.0, PAUSE_S))
        if time.monotonic() >= probe_s:
            killed.close()  # one that drives it is obeyed
            robot.check_live()
            stops.append(actions.stop_in_a_flood())
            journal.memory_mb.append(round(robot.taken().own_mb))
            journal.note("stop in a flood", f"stands after {stops[-1]:.2f} s")
            probe_s = time.monotonic() + PROBE_EVERY_S
    return stops


@pytest.mark.long
@pytest.mark.alone
def test_after_five_minutes_of_chaos_it_answers_drives_and_stops_as_before(
    machine, robot, server, killed, domain, capsys, tmp_path
):
    rng = random.Random(SEED)
    actions = Actions(robot, rng, domain, server, robot.files, killed)
    with Journal(robot, tmp_path / "node.log", machine) as journal:
        server.die()  # what is on board answers, before and after
        robot.settle()
        before = robot.first_minute()
        actions.warm_up()
        server.live()
        for action in actions.weighed():  # each once, so that what is loaded late is loaded
            journal.note(action.__name__, action())
        stops = run_chaos(actions, robot, killed, rng, journal, WARM_UP_S)
        first = rest(robot, server, killed)
        stops += run_chaos(actions, robot, killed, rng, journal, CHAOS_S - WARM_UP_S)
        last = rest(robot, server, killed)
        after = robot.first_minute()
        robot.check_live()
        robot.check_well()
        with capsys.disabled():
            tell(journal, stops, before, after, first, last, killed)
        for name, seconds in after.items():
            limit = LONGEST_S.get(name, SLOWER * before[name] + SLACK_S)
            then = f"{name} took {before[name]:.2f} s, and then {seconds:.2f} s"
            assert seconds < limit, f"{then}; {machine}"
        assert last.own_mb < first.own_mb + MARGIN_MB, f"{first}, then {last}"
        for what, late in LATE.items():
            most = asdict(first)[what] + late
            wait_until(
                lambda what=what, most=most: asdict(robot.taken())[what] <= most,
                f"{what}: {first}, then {robot.taken()}",
                GIVEN_UP_S,
            )
        broken = tracebacks(robot.agent.lines)
        assert not broken, "\n".join(broken)


def tracebacks(lines):
    """What broke that nobody expected: each traceback, up to the next entry of the log."""
    begins = [at for at, line in enumerate(lines) if re.match(r"\s*Traceback", line)]
    return ["\n".join(itertools.takewhile(_is_of_it, lines[at : at + TAIL])) for at in begins]


def _is_of_it(line):
    return not re.match(r"\d\d:\d\d:\d\d", line)


def rest(robot, server, killed):
    """Everything is as at the start, and what was killed is forgotten; what the node takes then."""
    killed.close()
    robot.files.restore()
    server.die()
    robot.settle()
    time.sleep(FORGOTTEN_S)
    return robot.taken()


def tell(journal, stops, before, after, first, last, killed):
    say(f"\nchaos: seed {SEED}, {journal.counts.total()} actions in {CHAOS_S:g} s")
    say(f"  {journal.machine}")
    say("  " + ", ".join(f"{count} {name}" for name, count in journal.counts.most_common()))
    say(f"  {killed.killed} peers killed; stops in a flood, s: {[round(s, 2) for s in stops]}")
    say(f"  its own memory every {PROBE_EVERY_S:g} s, MB: {journal.memory_mb}")
    say(f"  after {WARM_UP_S:g} s: {first}\n  at the end:  {last}")
    for name, seconds in before.items():
        say(f"  {name}: {seconds:.2f} s, then {after[name]:.2f} s")
