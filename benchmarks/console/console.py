"""The console in a real browser: its stop, map, sound and cost.

A press on stop counts from the browser's event to zero velocity at a ROS 2 peer, which hears it 100
times a second. The map's age is that of the state it shows, just before the next one. Speech
counts from the last loud frame that leaves the page to its goal, without speech to text, and beside
the same words on `audio_in`. The first sound counts from when the robot's loudspeaker is due to
play it to when the browser mixes it, without sound cards.
"""

import argparse
import bisect
import itertools
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ports import free_port
from robot_states import moving
from stop_rig import stands_for_good

from benchmarks.console.browser import monotonic_s, opened
from benchmarks.console.sitting import sitting
from benchmarks.console.speech import speech
from benchmarks.core.figures import Figure, Measured
from benchmarks.core.stopwatch import percent_of
from benchmarks.core.talker import Talker
from edgevox.console.sessions import Pairing, Role

TABLE = "The console"
ROUNDS = 20
LOOK_S = 20.0
VIEWERS = 10
PLACES = ("kitchen", "bedroom")
SLOW_ROUNDS = 5
SLOW = (
    ("content", "first visit on slow 4G, a processor four times slower: to content", 2.5),
    ("ready", "the same, to usable", 4.0),
    ("again", "the next visit, to usable", 3.0),
)
SLOW_4G = {
    "offline": False,
    "latency": 562.5,
    "downloadThroughput": 0.9 * 1.6e6 / 8,
    "uploadThroughput": 0.9 * 0.75e6 / 8,
}
"""As Chromium's developer tools have it: milliseconds, and bytes a second."""
PAGES = Path(__file__).with_name("pages.py")


def measure(quick: bool = False) -> Measured:
    """An agent that is driven and looked at, then one that is spoken to."""
    rounds = 3 if quick else ROUNDS
    figures = [*_driven(rounds, LOOK_S / 4 if quick else LOOK_S)]
    return Measured(figures=(*figures, *speech(TABLE, 2 if quick else ROUNDS // 2)))


def _driven(rounds: int, look_s: float) -> Iterator[Figure]:
    port, folder = free_port(), tempfile.mkdtemp()
    served = ("--console", "--console-tls=off", f"--console-port={port}")
    given = ("--llm=none", "--ros2-state-hz=100", *served, f"--console-folder={folder}")
    with Talker(*given) as talker:
        link = _link(talker)
        with opened(link) as page:
            stops = [1000 * _stopped_s(talker, page, one) for one in range(rounds)]
            yield Figure.of(
                "stop", TABLE, "press on stop to zero velocity", stops, "ms", wanted=50.0
            )
            yield Figure.of(
                "stop_worst", TABLE, "the slowest of them", [max(stops)], "ms", wanted=100.0
            )
            yield from _map(talker, page, look_s)
            loads = [_usable_ms(page) for _ in range(rounds)]
            yield Figure.of(
                "usable", TABLE, "page from click to usable", loads, "ms", wanted=1000.0
            )
            slow = [_slow_s(page) for _ in range(min(rounds, SLOW_ROUNDS))]
            for at, (name, what, wanted) in enumerate(SLOW):
                yield Figure.of(
                    f"slow_{name}", TABLE, what, [one[at] for one in slow], "s", wanted=wanted
                )
        time.sleep(2.0)
        alone = percent_of(talker.pid, look_s)
        code = Pairing(Path(folder)).offer(Role.VIEWER).code
        with _viewers(f"http://127.0.0.1:{port}", code, VIEWERS):
            seen = percent_of(talker.pid, look_s)
        yield Figure.of(
            "viewers",
            TABLE,
            "ten viewers, of a core, more than none",
            [seen - alone],
            "%",
            wanted=15.0,
        )


def _stopped_s(talker: Talker, page: Any, number: int) -> float:
    talker.say(f"go to the {PLACES[number % len(PLACES)]}")
    talker.robot.wait_for(moving, since=len(talker.robot.messages))
    since = len(talker.robot.messages)
    page.locator("button.stop").click()
    talker.robot.wait_for(stands_for_good, since=since)
    stood = next(i for i in range(since, 10**9) if stands_for_good(talker.robot.messages[i]))
    pressed_s = monotonic_s(page.evaluate("noted.pressed.at(-1)"))
    page.locator("html:not([data-moved])").wait_for()  # what moves it takes no press for a moment
    page.locator("button.resume").click()
    page.locator("html:not(.is-stopped)").wait_for()
    return talker.robot.times[stood] - pressed_s


def _map(talker: Talker, page: Any, look_s: float) -> Iterator[Figure]:
    talker.say(f"go to the {PLACES[0]}")
    page.evaluate("noted.live.length = 0")
    page.wait_for_timeout(1000 * look_s)
    told = [(at, monotonic_s(came)) for at, came in page.evaluate("noted.live")]
    heard = zip(talker.robot.messages, talker.robot.times, strict=False)
    when = {json.loads(message)["time"]: came_s for message, came_s in heard}
    times = sorted(when)
    ages = [
        1000 * (next_s - when[times[bisect.bisect_left(times, at) - 1]])
        for (at, _), (_, next_s) in itertools.pairwise(told)
        if times[0] < at
    ]
    yield Figure.of(
        "map_rate",
        TABLE,
        "robot and lidar on the map, a second",
        [round((len(told) - 1) / (told[-1][1] - told[0][1]), 1)],
        wanted=10.0,
        more_is_better=True,
    )
    yield Figure.of("map_age", TABLE, "their age, just before the next", ages, "ms", wanted=150.0)


def _usable_ms(page: Any) -> float:
    page.reload()
    page.locator("html[data-link=ready]").wait_for()
    return float(page.evaluate("noted.ready"))


def _slow_s(page: Any) -> tuple[float, float, float]:
    """A phone's first visit and its next one: seconds to content, to usable, to usable again."""
    devtools = page.context.new_cdp_session(page)
    devtools.send("Network.enable")
    devtools.send("Network.clearBrowserCache")
    devtools.send("Network.emulateNetworkConditions", SLOW_4G)
    devtools.send("Emulation.setCPUThrottlingRate", {"rate": 4})
    first_ms = _usable_ms(page)
    painted = "performance.getEntriesByName('first-contentful-paint')[0].startTime"
    content_ms = float(page.evaluate(painted))
    again_ms = _usable_ms(page)
    devtools.detach()
    return content_ms / 1000, first_ms / 1000, again_ms / 1000


def _link(talker: Talker) -> str:
    line = talker.agent.wait_for_line("#pair=")
    return next(word for word in line.split() if "#pair=" in word)


@contextmanager
def _viewers(url: str, code: str, many: int) -> Iterator[None]:
    program = [sys.executable, str(PAGES), url, code, str(many)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as viewers:
        try:
            assert viewers.stdout is not None
            assert viewers.stdout.readline() == "look\n"
            yield
        finally:
            viewers.terminate()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="What a console keeps of pages that come and go.")
    parser.add_argument("--sitting", type=float, metavar="MINUTES", required=True)
    for line in sitting(parser.parse_args().sitting):
        print(line, flush=True)
