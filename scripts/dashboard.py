"""Grafana's dashboard: `write` renews it, `check` only looks.

What it shows stands in `dashboard_panels`; all else that Grafana wants to know of a panel is made
here. Each expression is held against the metrics that exist by a test.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from dashboard_panels import ROWS, Panel

ROOT = Path(__file__).resolve().parent.parent
FILE = ROOT / "compose" / "observability" / "grafana" / "edgevox.json"
SOURCE = {"type": "prometheus", "uid": "${datasource}"}
COLUMNS, HEIGHT, LOW = 24, 8, 4


def dashboard() -> dict[str, Any]:
    """As Grafana takes it."""
    return {
        "uid": "edgevox",
        "title": "EdgeVox",
        "tags": ["edgevox"],
        "editable": True,
        "schemaVersion": 39,
        "version": 1,
        "refresh": "15s",
        "time": {"from": "now-1h", "to": "now"},
        "timezone": "browser",
        "templating": {"list": _variables()},
        "panels": list(_panels()),
    }


def _variables() -> list[dict[str, Any]]:
    return [
        {"name": "datasource", "label": "Source", "type": "datasource", "query": "prometheus"},
        {
            "name": "robot",
            "label": "Robot",
            "type": "query",
            "datasource": SOURCE,
            "query": "label_values(edgevox_build_info, robot)",
            "refresh": 2,
            "includeAll": True,
            "multi": True,
            "current": {"text": ["All"], "value": ["$__all"]},
        },
    ]


def _panels() -> Iterator[dict[str, Any]]:
    number, top = 0, 0
    for title, panels in ROWS:
        number += 1
        place = {"h": 1, "w": COLUMNS, "x": 0, "y": top}
        yield {"id": number, "type": "row", "title": title, "gridPos": place, "panels": []}
        left, top = 0, top + 1
        for panel in panels:
            number += 1
            if left + panel.width > COLUMNS:
                left, top = 0, top + _height(panel)
            place = {"h": _height(panel), "w": panel.width, "x": left, "y": top}
            yield {"id": number, "gridPos": place, **_panel(panel)}
            left += panel.width
        top += _height(panels[-1])


def _height(panel: Panel) -> int:
    return LOW if panel.kind == "stat" else HEIGHT


def _panel(panel: Panel) -> dict[str, Any]:
    targets = [
        {"refId": chr(ord("A") + i), "datasource": SOURCE, "expr": expression, "legendFormat": name}
        for i, (expression, name) in enumerate(panel.queries)
    ]
    if panel.kind == "stat":
        for target in targets:
            target["instant"] = True
    return {
        "type": panel.kind,
        "title": panel.title,
        "datasource": SOURCE,
        "targets": targets,
        "fieldConfig": {"defaults": _defaults(panel), "overrides": []},
        "options": _options(panel),
    }


def _defaults(panel: Panel) -> dict[str, Any]:
    found: dict[str, Any] = {"unit": panel.unit, "min": 0}
    if panel.words:
        options = {value: {"text": text, "color": colour} for value, text, colour in panel.words}
        found["mappings"] = [{"type": "value", "options": options}]
    if panel.kind == "timeseries":
        stacking = {"mode": "normal" if panel.stacked else "none", "group": "A"}
        fill = 25 if panel.stacked else 0
        found["custom"] = {"lineWidth": 1, "fillOpacity": fill, "stacking": stacking}
    return found


def _options(panel: Panel) -> dict[str, Any]:
    if panel.kind == "stat":
        named = "value_and_name" if panel.words else "name"
        return {"textMode": named, "colorMode": "background" if panel.words else "none"}
    return {
        "legend": {"displayMode": "list", "placement": "bottom", "showLegend": True},
        "tooltip": {"mode": "multi", "sort": "desc"},
    }


def main(arguments: Sequence[str]) -> int:
    """Run `write` or `check`; 2 for anything else."""
    wanted = json.dumps(dashboard(), indent=2) + "\n"
    match list(arguments):
        case ["write"]:
            FILE.write_text(wanted, encoding="utf-8")
            return 0
        case ["check"]:
            if FILE.is_file() and FILE.read_text(encoding="utf-8") == wanted:
                return 0
            sys.stderr.write(f"{FILE.name}: not current; run scripts/dashboard.py write\n")
            return 1
    sys.stderr.write("usage: dashboard.py write|check\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
