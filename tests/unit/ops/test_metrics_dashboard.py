"""Dashboard and alerts ask only for what exists: each expression is parsed as Prometheus would."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import promql_parser as promql
import pytest
import yaml

from edgevox.ops.metric_table import METRICS, Kind, Metric

ROOT = Path(__file__).parents[3]
PLACE = ROOT / "compose" / "observability"
OF_PROMETHEUS = {"job", "instance", "robot"}
SERIES = {name: metric for metric in METRICS.values() for name in metric.series}
BOARDS = {
    name: json.loads((PLACE / "grafana" / f"{name}.json").read_text())
    for name in ("edgevox", "edgevox-fleet")
}
COLUMNS = 24
"""Of Grafana's grid."""
PANELS = {
    f"{name}: {one['title']}": one
    for name, board in BOARDS.items()
    for one in board["panels"]
    if one["type"] != "row"
}
ALERTS = {
    rule["alert"]: rule
    for group in yaml.safe_load((PLACE / "alerts.yml").read_text())["groups"]
    for rule in group["rules"]
}
EXPRESSIONS = [
    pytest.param(target["expr"], id=f"{title} {target['refId']}")
    for title, panel in PANELS.items()
    for target in panel["targets"]
] + [pytest.param(rule["expr"], id=name) for name, rule in ALERTS.items()]


def parsed(expression: str) -> Any:
    return promql.parse(expression.replace("$__rate_interval", "5m"))


def parts(node: Any) -> Iterator[Any]:
    """The node and all below it."""
    yield node
    for name in ("expr", "lhs", "rhs", "vector_selector", "param"):
        if (below := getattr(node, name, None)) is not None and not isinstance(below, str | float):
            yield from parts(below)
    for below in getattr(node, "args", None) or ():
        yield from parts(below)


def selectors(expression: str) -> list[Any]:
    return [one for one in parts(parsed(expression)) if isinstance(one, promql.VectorSelector)]


def known_labels(metric: Metric) -> set[str]:
    return {*metric.labels, *OF_PROMETHEUS} | ({"le"} if metric.kind is Kind.HISTOGRAM else set())


def missing(expression: str) -> list[str]:
    """What an expression asks for that does not exist."""
    found = selectors(expression)
    assert found
    wrong = []
    allowed: set[str] = set(OF_PROMETHEUS)
    for one in found:
        if one.name == "up":
            continue
        if one.name not in SERIES:
            wrong.append(one.name)
            continue
        metric = SERIES[one.name]
        allowed |= known_labels(metric)
        for matcher in one.matchers.matchers:
            values = metric.labels.get(matcher.name, ())
            if matcher.name not in known_labels(metric):
                wrong.append(f"{one.name}{{{matcher.name}}}")
            elif isinstance(values, tuple) and values and matcher.value not in values:
                wrong.append(f"{one.name}{{{matcher.name}={matcher.value}}}")
    for one in parts(parsed(expression)):
        modifier = getattr(one, "modifier", None)
        labels = getattr(modifier, "labels", None) or ()
        wrong += [f"by {name}" for name in labels if name not in allowed]
    return wrong


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_an_expression_asks_for_metrics_and_labels_that_exist(expression) -> None:
    assert missing(expression) == []


@pytest.mark.parametrize(
    ("expression", "said"),
    [
        ("rate(edgevox_turn_total[5m])", ["edgevox_turn_total"]),
        ("edgevox_turn_stage_seconds", ["edgevox_turn_stage_seconds"]),
        ("edgevox_ready{skill='x'}", ["edgevox_ready{skill}"]),
        ("edgevox_turns_total{outcome='faild'}", ["edgevox_turns_total{outcome=faild}"]),
        ("1 - sum by (skil) (edgevox_skill_goals_running)", ["by skil"]),
        ("edgevox_ready > bool on (robot) edgevox_redy", ["edgevox_redy"]),
    ],
)
def test_one_that_does_not_exist_is_found(expression, said) -> None:
    assert missing(expression) == said


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_counters_and_histograms_are_looked_at_as_they_grow(expression) -> None:
    tree = parsed(expression)
    ranges = [one for one in parts(tree) if isinstance(one, promql.MatrixSelector)]
    grown = {one.vector_selector.name for one in ranges}
    for one in selectors(expression):
        counts = one.name in SERIES and SERIES[one.name].kind is not Kind.GAUGE
        assert (one.name in grown) == counts, one.name


def test_every_metric_is_on_the_dashboard_or_in_an_alert() -> None:
    asked = {one.name for expression in EXPRESSIONS for one in selectors(expression.values[0])}
    unseen = {name for name, metric in METRICS.items() if not metric.series & asked}

    assert unseen == {
        "edgevox_muted",
        "process_virtual_memory_bytes",
        "process_start_time_seconds",
    }


def test_every_panel_asks_the_chosen_source_for_the_chosen_robots_by_letters_of_its_own() -> None:
    for title, panel in PANELS.items():
        sources = [panel["datasource"], *(one["datasource"] for one in panel["targets"])]
        assert all(one["uid"] == "${datasource}" for one in sources), title
        letters = [one["refId"] for one in panel["targets"]]
        assert len(set(letters)) == len(letters), title
        for target in panel["targets"]:
            for one in selectors(target["expr"]):
                chosen = {m.name: m.value for m in one.matchers.matchers}
                assert chosen.get("robot") == "$robot", title


def test_names_of_lines_and_alerts_use_labels_that_the_expression_keeps() -> None:
    texts = [
        (target["expr"], target["legendFormat"]) for p in PANELS.values() for target in p["targets"]
    ] + [(rule["expr"], rule["annotations"]["summary"]) for rule in ALERTS.values()]
    for expression, text in texts:
        known = set(OF_PROMETHEUS)
        for one in selectors(expression):
            known |= set(SERIES[one.name].labels) if one.name in SERIES else set()
        used = set(re.findall(r"\{\{ ?(?:\$labels\.)?([a-z]+) ?\}\}", text))
        assert used <= known, text


def test_each_board_is_told_from_the_others_and_is_called_as_its_file() -> None:
    assert {name: board["uid"] for name, board in BOARDS.items()} == {n: n for n in BOARDS}


@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
def test_panels_do_not_lie_on_each_other(board) -> None:
    taken: set[tuple[int, int]] = set()
    for panel in board["panels"]:
        at = panel["gridPos"]
        cells = {(at["x"] + x, at["y"] + y) for x in range(at["w"]) for y in range(at["h"])}
        assert not cells & taken
        assert at["x"] + at["w"] <= COLUMNS
        taken |= cells
    assert len({panel["id"] for panel in board["panels"]}) == len(board["panels"])


def test_prometheus_reads_the_rules_and_every_robot_of_the_fleet() -> None:
    config = yaml.safe_load((PLACE / "prometheus.yml").read_text())
    fleet = yaml.safe_load((ROOT / "compose" / "fleet.yml").read_text())
    jobs = {job["job_name"]: job for job in config["scrape_configs"]}
    (robots,) = jobs["edgevox"]["dns_sd_configs"]

    assert config["rule_files"] == ["/etc/prometheus/alerts.yml"]
    assert {*robots["names"], "fleet-page"} == {*fleet["services"], "recorder"}
    assert jobs["edgevox"]["relabel_configs"][0]["target_label"] == "robot"


def test_prometheus_reads_the_door_before_a_shared_language_model() -> None:
    config = yaml.safe_load((PLACE / "prometheus.yml").read_text())
    services = yaml.safe_load((ROOT / "compose" / "llm-queue.yml").read_text())["services"]
    jobs = {job["job_name"]: job for job in config["scrape_configs"]}
    (door,) = jobs["llm-queue"]["dns_sd_configs"]

    assert door["names"] == list(services)
    bound = services["llm-queue"]["environment"]["LLM_QUEUE_METRICS_BIND"]
    assert bound == f":{door['port']}"
