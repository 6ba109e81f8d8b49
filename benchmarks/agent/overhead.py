"""The cost of logs, metrics and diagnostics: an agent with all of them beside one with none.

Both run at once, at rest and then turn by turn, in CPU time. With all: JSON lines from info on into
a pipe; metrics fetched every five seconds (Prometheus usually asks every 15 to 60 s);
`/diagnostics` at 1 Hz with a subscriber. A server with the delay of the small model answers the
sentences for the model, since a real one is noisier than the difference.
"""

import statistics
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

from llm_server import Reply, serving
from ports import free_port

from benchmarks.core.figures import Figure, Measured
from benchmarks.core.stopwatch import cpu_s, repeatedly
from benchmarks.core.talker import PLAIN, QUESTIONS, Talker
from benchmarks.wire.listener import listener
from edgevox.agent.llm.protocol import SAY

TABLE = "Logs, metrics and diagnostics"
BARE = (sys.executable, str(Path(__file__).with_name("bare.py")))
ON, OFF = "with all", "with none"
SCRAPE_S = 5.0
SETTLE_S = 5.0
WANTED_PERCENT = 1.0
FOR_THE_MODEL = QUESTIONS[0]
FIRST_S, BETWEEN_S = 0.35, 0.025
"""What Qwen2.5-Coder 0.5B takes on two cores until its first token, and between two."""
ANSWER = "I am a robot and I drive through the rooms of this house ."
Talkers = dict[str, Talker]


def measure(quick: bool = False) -> Measured:
    """At rest, then plain commands, then sentences for the model."""
    with ExitStack() as stack:
        url = stack.enter_context(_paced_model())
        talkers = _talkers(stack, url)
        for one in talkers.values():  # what is loaded only once
            _turn(one, PLAIN[0]), _turn(one, FOR_THE_MODEL)
        time.sleep(SETTLE_S)
        windows, window_s = (2, 3.0) if quick else (6, 15.0)
        rest = _at_rest(talkers, windows, window_s)
        shares = {name: statistics.median(samples) / 100 for name, samples in rest.items()}
        turns = [
            figure
            for name, what, text, size in (
                ("plain", "plain command", PLAIN[0], 50),
                ("model", "sentence for a model", FOR_THE_MODEL, 5),
            )
            for figure in _of_turns(
                name, what, talkers, shares, texts=[text] * size, blocks=2 if quick else 10
            )
        ]
    return Measured(
        figures=(
            *_figures("rest", "at rest", rest, "% of a core"),
            _extra("rest", "at rest", rest, 1.0),
            *turns,
        )
    )


def _talkers(stack: ExitStack, url: str) -> Talkers:
    """Both agents, the one with all of it under the eyes of those who look at it."""
    port = free_port()
    common = ("--llm=none", f"--llm-endpoint={url}", "--llm-endpoint-grammar=none")
    told = ("--log-level=info", "--log-format=json", f"--metrics-port={port}")
    on = stack.enter_context(Talker(*common, *told))
    stack.enter_context(listener("diagnostics", str(on.domain)))
    fetch = partial(_fetch_metrics, port)
    stack.enter_context(repeatedly(fetch, SCRAPE_S, "scraper"))
    off = stack.enter_context(Talker(*common, "--log-level=error", program=BARE))
    return {ON: on, OFF: off}


def _at_rest(talkers: Talkers, windows: int, seconds: float) -> dict[str, list[float]]:
    """Percent of a core, both in the same windows of time."""
    shares: dict[str, list[float]] = {name: [] for name in talkers}
    for _ in range(windows):
        before = {name: (time.monotonic(), cpu_s(one.pid)) for name, one in talkers.items()}
        time.sleep(seconds)
        for name, one in talkers.items():
            began, worked = before[name]
            shares[name].append(100 * (cpu_s(one.pid) - worked) / (time.monotonic() - began))
    return shares


def _of_turns(
    identifier: str,
    what: str,
    talkers: Talkers,
    rest: dict[str, float],
    *,
    texts: Sequence[str],
    blocks: int,
) -> Iterator[Figure]:
    """Milliseconds of the processor for a turn, beyond what rest takes, and how long it lasts."""
    work: dict[str, list[float]] = {name: [] for name in talkers}
    lasts: dict[str, list[float]] = {name: [] for name in talkers}
    order = list(talkers)
    for _ in range(blocks):
        for name in order:
            one, began = talkers[name], time.monotonic()
            worked = cpu_s(one.pid)
            turns = [1000 * _turn(one, text) for text in texts]
            spent = cpu_s(one.pid) - worked - rest[name] * (time.monotonic() - began)
            work[name].append(1000 * spent / len(turns))
            lasts[name].append(statistics.median(turns))
        order.reverse()
    yield from _figures(f"{identifier}.time", f"{what}, to its end", lasts, "ms")
    yield from _figures(f"{identifier}.work", f"{what}, of the processor", work, "ms")
    yield _extra(
        f"{identifier}.work", f"{what}, of the processor", work, 100 / statistics.median(lasts[OFF])
    )


def _turn(talker: Talker, text: str) -> float:
    """Seconds from the words out to the agent that listens again."""
    if text == FOR_THE_MODEL:
        talker.forget()
    heard = len(talker.state.messages)
    began = talker.say(text)
    talker.state.wait_for(lambda state: state == "listening", timeout_s=60, since=heard)
    return talker.state.times[-1] - began


def _figures(
    identifier: str, what: str, samples: dict[str, list[float]], unit: str
) -> Iterator[Figure]:
    for name in (ON, OFF):
        yield Figure.of(
            f"{identifier}.{name.split()[1]}", TABLE, what, samples[name], unit, column=name,
            baseline=f"{identifier}.none" if name == ON else "",
        )  # fmt: skip


def _extra(identifier: str, what: str, samples: dict[str, list[float]], scale: float) -> Figure:
    """What one costs more than the other, window by window."""
    more = [scale * (a - b) for a, b in zip(samples[ON], samples[OFF], strict=True)]
    return Figure.of(
        f"{identifier}.more", TABLE, what, more, "%", column="more", wanted=WANTED_PERCENT
    )


def _fetch_metrics(port: int) -> None:
    """As Prometheus does."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics") as reply:
        reply.read()


def _answer(reply: Reply) -> None:
    """One answer in words, at the pace of a model."""
    pause = threading.Event()
    pause.wait(FIRST_S)
    reply.stream()
    reply.piece(SAY.strip())
    for word in ANSWER.split():
        reply.piece(f" {word}")
        pause.wait(BETWEEN_S)
    reply.piece(None, "stop")
    reply.raw("data: [DONE]\n\n")


@contextmanager
def _paced_model() -> Iterator[str]:
    """Have a model that takes the time of the small one and no work; its address."""
    with serving(_answer) as server:
        yield server.url
