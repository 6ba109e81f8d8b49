"""Pictures as SVG: drawn by hand, so that the same figures always make the same file."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log10, sqrt
from xml.sax.saxutils import escape

WIDTH, LABELS, NUMBERS, ROW, TOP = 760, 350, 70, 26, 34
SQUARE, LEFT, SMALLEST, LARGEST = 320, 60, 3.0, 14.0
STYLE = """
  text { font: 13px sans-serif; fill: #24292f } .head { font-weight: bold }
  .bar { fill: #4c78a8 } .mark { stroke: #d1661f; stroke-width: 1.5; stroke-dasharray: 4 3 }
  .axis { stroke: #8c959f } .dot { fill: #4c78a8; fill-opacity: 0.8 }
  @media (prefers-color-scheme: dark) { text { fill: #e6edf3 } .bar, .dot { fill: #79a6d2 } }
"""


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar: what it is, how long it is, what is written at its end."""

    label: str
    value: float
    text: str


def bars(title: str, rows: Sequence[Bar], *, logarithmic: bool = False, mark: float = 0.0) -> str:
    """A picture of horizontal bars, from 0 or on a scale of powers of ten; `mark` draws a line."""
    room = WIDTH - LABELS - NUMBERS
    values = [row.value for row in rows] + ([mark] if mark else [])
    low = min(values) / 2 if logarithmic else 0.0
    high = max(values)

    def length(value: float) -> float:
        if logarithmic:
            return room * (log10(value) - log10(low)) / (log10(high) - log10(low))
        return room * max(0.0, value) / high

    line = length(mark) if mark else 0.0
    height = TOP + ROW * len(rows) + 10
    lines = _framed(title, WIDTH, height)
    for index, row in enumerate(rows):
        y, end = TOP + ROW * index, length(row.value)
        # Beyond the mark where it would go through the number.
        told = line if mark and end < line < end + NUMBERS / 2 else end
        lines += [
            f'<text x="{LABELS - 8}" y="{y + 16}" text-anchor="end">{escape(row.label)}</text>',
            f'<rect class="bar" x="{LABELS}" y="{y + 4}" width="{end:.1f}" height="{ROW - 10}"/>',
            f'<text x="{LABELS + told + 6:.1f}" y="{y + 16}">{escape(row.text)}</text>',
        ]
    foot = TOP + ROW * len(rows)
    lines.append(f'<line class="axis" x1="{LABELS}" y1="{TOP}" x2="{LABELS}" y2="{foot}"/>')
    if mark:
        x = f"{LABELS + line:.1f}"
        lines.append(f'<line class="mark" x1="{x}" y1="{TOP}" x2="{x}" y2="{foot}"/>')
    return "\n".join([*lines, "</svg>", ""])


@dataclass(frozen=True, slots=True)
class Dot:
    """So many cases of an average confidence `x`, of which the share `y` was right, both 0 to 1."""

    x: float
    y: float
    count: int


def reliability(title: str, across: str, up: str, dots: Sequence[Dot]) -> str:
    """Dots in a square, the larger the more cases; on the dashed line the confidence is kept."""
    width, height = LEFT + SQUARE + 40, TOP + SQUARE + 56
    foot, most = TOP + SQUARE, max((dot.count for dot in dots), default=1)
    lines = [
        *_framed(title, width, height),
        f'<line class="axis" x1="{LEFT}" y1="{TOP}" x2="{LEFT}" y2="{foot}"/>',
        f'<line class="axis" x1="{LEFT}" y1="{foot}" x2="{LEFT + SQUARE}" y2="{foot}"/>',
        f'<line class="mark" x1="{LEFT}" y1="{foot}" x2="{LEFT + SQUARE}" y2="{TOP}"/>',
    ]
    for tick in (0.0, 0.25, 0.5, 0.75, 1.0):
        x, y = LEFT + SQUARE * tick, foot - SQUARE * tick
        lines += [
            f'<text x="{x:.1f}" y="{foot + 18}" text-anchor="middle">{tick:g}</text>',
            f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{tick:.0%}</text>',
        ]
    for dot in dots:
        x, y = LEFT + SQUARE * dot.x, foot - SQUARE * dot.y
        radius = max(SMALLEST, LARGEST * sqrt(dot.count / most))
        lines.append(
            f'<circle class="dot" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}">'
            f"<title>{dot.y:.0%} of {dot.count}</title></circle>"
        )
    middle = LEFT + SQUARE / 2
    lines += [
        f'<text x="{middle:.1f}" y="{foot + 42}" text-anchor="middle">{escape(across)}</text>',
        f'<text x="{LEFT + 10}" y="{TOP + 14}">{escape(up)}</text>',
    ]
    return "\n".join([*lines, "</svg>", ""])


def _framed(title: str, width: int, height: int) -> list[str]:
    frame = f'viewBox="0 0 {width} {height}" role="img" aria-label="{escape(title)}"'
    return [
        f'<svg xmlns="http://www.w3.org/2000/svg" {frame}>',
        f"<style>{STYLE}</style>",
        f'<text class="head" x="8" y="20">{escape(title)}</text>',
    ]
