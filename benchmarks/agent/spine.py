"""How much of the code a typed sentence passes before a wheel turns.

The threads of an agent with the apartment's robot run under Python's profiler, from the message on
`text_input` to the first motion. Only EdgeVox's own code counts, without what runs at rest.
"""

import threading
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import edgevox
from benchmarks.core.figures import Figure, Measured
from benchmarks.core.talker import Peer, isolate, wait_until
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.robots import build_body
from edgevox.core.settings import load_settings
from edgevox.robots.capabilities import Body, HasPose

TABLE = "From `text_input` to motion"
OURS = str(Path(edgevox.__file__).parent)
SENTENCE = "go to the kitchen"
REST_S = 3.0
MOVES_M_S = 0.01
FILES_WANTED, HAND_OVERS_WANTED = 25, 3
LOOKS_ON = "edgevox-ticker"
"""The thread that publishes the state at its rate, whatever is asked."""


@dataclass(frozen=True, slots=True)
class Called:
    """A function of ours, and the thread that called it."""

    thread: str
    file: str
    function: str


class Profiler:
    """Notes every function of ours that a thread calls which was started under it."""

    def __init__(self) -> None:
        self._called: set[tuple[str, CodeType]] = set()

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(OURS):
            self._called.add((threading.current_thread().name, frame.f_code))

    def taken(self) -> set[Called]:
        """What was called since this was last asked."""
        called, self._called = self._called, set()
        return {Called(thread, code.co_filename, code.co_qualname) for thread, code in called}


def measure(quick: bool = False) -> Measured:
    """One sentence; it is the same way every time."""
    with ExitStack() as stack:
        way = sentence(stack, 1.0 if quick else REST_S)
    files = sorted({Path(one.file).relative_to(OURS).as_posix() for one in way})
    threads = sorted({one.thread for one in way})
    rows = (
        ("files", "files", len(files), FILES_WANTED),
        ("functions", "functions", len({(one.file, one.function) for one in way}), None),
        ("hand_overs", "hand-overs between threads", len(threads) - 1, HAND_OVERS_WANTED),
    )
    return Measured(
        figures=tuple(
            Figure.of(name, TABLE, what, [float(count)], wanted=wanted)
            for name, what, count, wanted in rows
        ),
        notes={"The way of a sentence, by thread": told(way)},
    )


def sentence(stack: ExitStack, rest_s: float) -> set[Called]:
    """What is called for a sentence, and is not called at rest."""
    domain = isolate()
    profiler = Profiler()
    settings = load_settings({"ros2": True, "text_mode": True, "llm": "none"})
    threading.setprofile(profiler)
    stack.callback(threading.setprofile, None)
    body = build_body("robot-apartment", settings)
    start_parts(stack, build_parts(stack, settings, body))
    peer = Peer(domain)
    stack.callback(peer.close)
    peer.send("text_input", "hello")  # whoever comes first waits for discovery
    time.sleep(rest_s)
    profiler.taken()
    time.sleep(rest_s)
    at_rest = {(one.file, one.function) for one in profiler.taken()}
    peer.send("text_input", SENTENCE)
    wait_until(lambda: moves(body), "motion")
    way = profiler.taken()
    return {o for o in way if (o.file, o.function) not in at_rest and o.thread != LOOKS_ON}


def moves(body: Body) -> bool:
    """Whether a wheel turns."""
    return isinstance(body, HasPose) and abs(body.velocity().linear_m_s) > MOVES_M_S


def told(way: set[Called]) -> tuple[str, ...]:
    """A line for each thread: the files that it passes through."""
    threads = sorted({one.thread for one in way})
    return tuple(
        f"{thread}: "
        + ", ".join(
            sorted({Path(o.file).relative_to(OURS).as_posix() for o in way if o.thread == thread})
        )
        for thread in threads
    )
