"""Metrics as Prometheus would scrape them from an agent that runs."""

import socket
import threading
import time
import urllib.request
from collections.abc import Callable

from guards import HUNG_S
from prometheus_client.parser import text_string_to_metric_families

PATIENCE_S = HUNG_S

Scrape = dict[tuple[str, ...], float]


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as one:
        return int(one.getsockname()[1])


def scrape(port: int) -> Scrape:
    """Each sample by its name and the values of its labels."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=HUNG_S) as answer:
        families = list(text_string_to_metric_families(answer.read().decode()))
    return {
        (sample.name, *(sample.labels[name] for name in sorted(sample.labels))): sample.value
        for family in families
        for sample in family.samples
    }


def wait_until(port: int, true: Callable[[Scrape], bool]) -> Scrape:
    """The first scrape of which that is true."""
    deadline_s, pause = time.monotonic() + PATIENCE_S, threading.Event()
    found: Scrape = {}
    while time.monotonic() < deadline_s:
        try:
            found = scrape(port)
        except OSError:
            found = {}
        if found and true(found):
            return found
        pause.wait(0.2)
    raise AssertionError(found)
