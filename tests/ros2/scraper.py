"""Metrics as Prometheus would scrape them from an agent that runs."""

import urllib.request
from collections.abc import Callable
from contextlib import suppress

from guards import HUNG_S
from prometheus_client.parser import text_string_to_metric_families
from waiting import wait_until

Scrape = dict[tuple[str, ...], float]


def scrape(port: int) -> Scrape:
    """Each sample by its name and the values of its labels."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=HUNG_S) as answer:
        families = list(text_string_to_metric_families(answer.read().decode()))
    return {
        (sample.name, *(sample.labels[name] for name in sorted(sample.labels))): sample.value
        for family in families
        for sample in family.samples
    }


def scrape_until(port: int, true: Callable[[Scrape], bool]) -> Scrape:
    """The first scrape of which that is true."""
    seen: Scrape = {}

    def look() -> bool:
        seen.clear()
        with suppress(OSError):
            seen.update(scrape(port))
        return bool(seen) and true(seen)

    wait_until(look, "metrics of which that is true")
    return seen
