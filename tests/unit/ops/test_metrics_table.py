"""The table of metrics: named as Prometheus asks, and true to what the code says."""

import re

import pytest
from prometheus_client.parser import text_string_to_metric_families

from edgevox.core.agent_events import GOAL_ENDS
from edgevox.ops.metric_table import METRICS, SKILLS, SOURCES, Kind
from edgevox.ops.metrics import Registry

PREFIX = "edgevox_"
UNITS = ("seconds", "bytes", "total", "info", "factor")
"""How the name of a number with a unit ends; all others count or say yes or no."""
BARE = {
    "edgevox_skill_goals_running",
    "edgevox_state",
    "edgevox_ready",
    "edgevox_check_ok",
    "edgevox_muted",
    "edgevox_policy_broken",
    "edgevox_recordings_upload_failed",
    "edgevox_threads",
    "edgevox_llm_server_up",
    "edgevox_stt_server_up",
    "edgevox_tts_server_up",
    "process_open_fds",
    "process_max_fds",
}


@pytest.mark.parametrize("metric", METRICS.values(), ids=lambda one: one.name)
def test_a_metric_is_named_as_prometheus_asks(metric) -> None:
    assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)+", metric.name)
    assert metric.name.startswith((PREFIX, "process_"))
    assert metric.name.endswith(UNITS) or metric.name in BARE
    assert metric.name.endswith("_total") == (metric.kind is Kind.COUNTER)
    assert not re.search(r"_(ms|milliseconds|minutes|kb|mb|percent)(_|$)", metric.name)


@pytest.mark.parametrize("metric", METRICS.values(), ids=lambda one: one.name)
def test_a_metric_says_what_it_is_and_by_what_it_is_told_apart(metric) -> None:
    assert metric.help[0].isupper() or metric.help[0].isdigit()
    assert not metric.help.endswith(".")
    assert bool(metric.buckets) == (metric.kind is Kind.HISTOGRAM)
    assert list(metric.buckets) == sorted(set(metric.buckets))
    for name, known in metric.labels.items():
        assert re.fullmatch(r"[a-z]+", name)
        assert name not in {"job", "instance", "robot", "le", "quantile"}
        assert known, "a closed set, or a word for one"


def test_no_series_belongs_to_two_metrics() -> None:
    series = [name for metric in METRICS.values() for name in metric.series]

    assert len(series) == len(set(series))


def test_the_sets_of_labels_are_those_of_the_code() -> None:
    assert set(METRICS["edgevox_skill_goals_total"].labels["outcome"]) == set(GOAL_ENDS)
    assert set(SOURCES) == {"template", "reading", "command", "action", "program"}


def test_a_scrape_can_be_parsed_and_holds_all_that_is_counted_from_the_start() -> None:
    text = Registry({SKILLS: ["wave"]}).text().decode()

    families = {family.name: family for family in text_string_to_metric_families(text)}
    for metric in METRICS.values():
        if metric.read:
            continue
        family = families[metric.name.removesuffix("_total")]
        assert family.type == str(metric.kind)
        assert family.documentation == metric.help
        assert {sample.name for sample in family.samples} == metric.series
        assert all(set(s.labels) - {"le"} == set(metric.labels) for s in family.samples)


def test_what_the_process_says_of_itself_is_what_the_table_has() -> None:
    text = Registry({}).text().decode()

    found = {family.name for family in text_string_to_metric_families(text)}
    declared = {name.removesuffix("_total") for name in METRICS if name.startswith("process_")}
    assert {name for name in found if name.startswith("process_")} == declared
    assert all(name.startswith((PREFIX, "process_")) for name in found)
