"""Draw the packages of EdgeVox and who imports whom, from the code: `write` or `check`.

The rows are the layers that pyproject.toml has import-linter hold; sentences are the packages' own
first ones; an arrow is there because at least one module imports one of the other package. `check`
says whether picture and table are still true.
"""

import ast
import html
import re
import sys
import textwrap
import tomllib
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import grimp

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs" / "images" / "architecture.svg"
PAGE = ROOT / "docs" / "architecture.md"
BLOCK = re.compile(r"(<!-- generated: packages -->\n).*?(<!-- end -->)", re.DOTALL)

WIDTH, MARGIN, GAP = 1080, 20, 84
ROW, CHANNEL = 94, 62
LINES = 3
NARROW = {
    "security": (0.72, 0.26),
    "ros2": (0.3, 0.24),
    "agent": (0.08, 0.3),
    "models": (0.56, 0.22),
}
"""Where a package of a layer with few stands, and how wide, so that arrows get past it."""
SLOT, APART, CLEAR = 4, 22, 12
COLOURS = {
    "apps": "#7e57c2",
    "security": "#37474f",
    "ros2": "#1e88e5",
    "robots": "#00897b",
    "voice": "#e67700",
    "models": "#c2185b",
    "ops": "#6d4c41",
    "scenario": "#558b2f",
    "console": "#00838f",
    "agent": "#d84315",
    "core": "#546e7a",
}
STYLE = """
text { font-family: system-ui, "DejaVu Sans", sans-serif; fill: #263238 }
.ground { fill: #fafafa }
.box { fill: #ffffff; stroke-width: 2 }
.name { font-size: 17px; font-weight: 700 }
.about { font-size: 12.5px }
.arrow { fill: none; stroke-width: 1.8 }
@media (prefers-color-scheme: dark) {
  text { fill: #eceff1 }
  .ground { fill: #1e2129 }
  .box { fill: #2b2f3a }
}
"""


@dataclass(frozen=True)
class Box:
    """A package's place in the picture."""

    name: str
    row: int
    left: float
    width: float

    @property
    def top(self) -> float:
        """Its upper edge; rows are apart by a channel in which arrows turn."""
        return MARGIN + self.row * (ROW + CHANNEL)

    @property
    def middle(self) -> float:
        """Its centre, sidewards."""
        return self.left + self.width / 2

    def covers(self, x: float) -> bool:
        """Whether an arrow at x would touch it."""
        return self.left - CLEAR < x < self.left + self.width + CLEAR


@dataclass(frozen=True)
class Imports:
    """What the code says: who imports whom, and which libraries."""

    inside: set[tuple[str, str]]
    libraries: dict[str, set[str]]


def read_imports() -> Imports:
    """Read every import of every module; nothing is executed."""
    graph = grimp.build_graph("edgevox", include_external_packages=True, cache_dir=None)
    inside: set[tuple[str, str]] = set()
    libraries: dict[str, set[str]] = defaultdict(set)
    for module in graph.modules:
        if package := _package(module):
            imported = graph.find_modules_directly_imported_by(module)
            inside |= {(package, _package(one)) for one in imported}
            libraries[package] |= {one for one in imported if not one.startswith("edgevox")}
    return Imports(inside, libraries)


def _package(module: str) -> str:
    root, _, rest = module.partition(".")
    return rest.partition(".")[0] if root == "edgevox" else ""


def layers() -> list[list[str]]:
    """The packages by layer, the uppermost first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (rows,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [[one.strip() for one in row.split("|")] for row in rows]


def place(rows: list[list[str]]) -> dict[str, Box]:
    """Where each package is drawn."""
    boxes = {}
    inner = WIDTH - 2 * MARGIN
    for number, row in enumerate(rows):
        width = (inner - GAP * (len(row) - 1)) / len(row)
        for column, name in enumerate(row):
            boxes[name] = Box(name, number, MARGIN + column * (width + GAP), width)
    for name, (left, width) in NARROW.items():
        boxes[name] = Box(name, boxes[name].row, MARGIN + inner * left, inner * width)
    return boxes


def draw(imports: Imports) -> str:
    """The picture."""
    rows = layers()
    boxes = place(rows)
    height = 2 * MARGIN + len(rows) * ROW + (len(rows) - 1) * CHANNEL
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img">',
        "<title>The packages of EdgeVox, and who imports whom</title>",
        f"<style>{STYLE}</style>",
        f'<rect class="ground" width="{WIDTH}" height="{height}" rx="10"/>',
        *(
            f'<marker id="to-{name}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
            f'markerHeight="7" orient="auto"><path d="M0 0 8 4 0 8z" fill="{colour}"/></marker>'
            for name, colour in COLOURS.items()
        ),
        *_arrows(imports, boxes),
        *(part for box in boxes.values() for part in _box(box)),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _box(box: Box) -> list[str]:
    lines = _fitting(_about(box.name), int(box.width / 7.2))
    texts = [("name", 28, box.name), *(("about", 49 + 17 * n, one) for n, one in enumerate(lines))]
    frame = (
        f'<rect class="box" x="{box.left:.0f}" y="{box.top:.0f}" width="{box.width:.0f}" '
        f'height="{ROW}" rx="8" stroke="{COLOURS[box.name]}"/>'
    )
    return [
        frame,
        *(
            f'<text class="{kind}" x="{box.middle:.0f}" y="{box.top + below:.0f}" '
            f'text-anchor="middle">{html.escape(text)}</text>'
            for kind, below, text in texts
        ),
    ]


def _fitting(about: str, characters: int) -> list[str]:
    """A sentence in lines, cut at a mark if it is too long."""
    for mark in ("\0", ";", ":", ","):
        lines = textwrap.wrap(about.partition(mark)[0], characters)
        if len(lines) <= LINES:
            return lines
    return lines[:LINES]


def _about(package: str) -> str:
    """What a package is, in the first sentence of its own words."""
    code = (ROOT / "edgevox" / package / "__init__.py").read_text(encoding="utf-8")
    text = (ast.get_docstring(ast.parse(code)) or "").partition("\n\n")[0].replace("\n", " ")
    return re.split(r"\.(?: |$)", text)[0].replace("`", "")


def _arrows(imports: Imports, boxes: dict[str, Box]) -> list[str]:
    """Each leaves the middle of its box, runs sidewards in the channel below, and drops down."""
    taken: list[tuple[float, int, int]] = []
    parts = []
    drawn = [
        (boxes[source], boxes[target])
        for source, target in imports.inside
        if source != target and target in boxes
    ]
    for source, target in sorted(drawn, key=_near_first):
        x = _free(source, target, boxes, taken)
        taken.append((x, source.row, target.row))
        below = source.top + ROW
        path = f"M{x:.0f} {below:.0f}"
        if not source.left < x < source.left + source.width:
            turn = below + CHANNEL * (0.36 + 0.3 * (source.left / WIDTH))
            path = f"M{source.middle:.0f} {below:.0f}V{turn:.0f}H{x:.0f}"
        parts.append(
            f'<path class="arrow" d="{path}V{target.top - 1:.0f}" '
            f'stroke="{COLOURS[source.name]}" marker-end="url(#to-{source.name})"/>'
        )
    return parts


def _near_first(arrow: tuple[Box, Box]) -> tuple[int, float, float, str, str]:
    source, target = arrow  # their names settle what else a set's order would
    return target.row - source.row, target.left, source.left, source.name, target.name


def _free(
    source: Box, target: Box, boxes: dict[str, Box], taken: list[tuple[float, int, int]]
) -> float:
    """Where an arrow can drop without touching a box or another arrow, nearest to its source."""
    between = [box for box in boxes.values() if source.row < box.row < target.row]
    slots = [target.left + SLOT * n for n in range(2, int(target.width / SLOT) - 1)]
    free = [
        x
        for x in slots
        if not any(box.covers(x) for box in between)
        and not any(
            abs(x - other) < APART and first < target.row and last > source.row
            for other, first, last in taken
        )
    ]
    wanted = min(max(source.middle, target.left), target.left + target.width)
    return min(free or slots, key=lambda x: (abs(x - wanted), x))


def table(imports: Imports) -> str:
    """The same in words: what each package imports, of EdgeVox and of others."""
    lines = ["| package | what | imports | stands on |", "| --- | --- | --- | --- |"]
    for name in (name for row in layers() for name in row):
        inside = [other for row in layers() for other in row if (name, other) in imports.inside]
        own = ", ".join(f"`{other}`" for other in inside if other != name)
        others = ", ".join(f"`{one}`" for one in sorted(_told(imports.libraries[name])))
        lines.append(f"| `{name}` | {_about(name)} | {own or 'nothing'} | {others} |")
    return "\n".join(lines) + "\n"


def _told(libraries: set[str]) -> set[str]:
    """Libraries that do not come with Python; ROS 2's interfaces go with rclpy."""
    roots = {one.partition(".")[0] for one in libraries} - sys.stdlib_module_names
    interfaces = {one for one in roots if one.endswith(("_msgs", "_srvs", "_interfaces"))}
    return roots - interfaces


def main(arguments: list[str]) -> int:
    """Run `write` or `check`; 2 for anything else."""
    imports = read_imports()
    page = BLOCK.sub(
        lambda found: found[1] + table(imports) + found[2], PAGE.read_text(encoding="utf-8")
    )
    wanted = {PICTURE: draw(imports), PAGE: page}
    match arguments:
        case ["write"]:
            for file, text in wanted.items():
                file.write_text(text, encoding="utf-8")
            return 0
        case ["check"]:
            old = [
                f
                for f, text in wanted.items()
                if not f.is_file() or f.read_text(encoding="utf-8") != text
            ]
            for file in old:
                sys.stderr.write(
                    f"{file.name}: not current; run docs/render_architecture.py write\n"
                )
            return 1 if old else 0
    sys.stderr.write("usage: render_architecture.py write|check\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
