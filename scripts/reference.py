"""What is generated in docs: `write` renews it, `check` only looks.

The tables of the package `docs` beside this file stand between ``<!-- generated: NAME -->`` and
``<!-- end -->``; all else on a page is written by hand. scenario.schema.json, policy.schema.json
and robot.schema.json are the formats of such files as JSON Schemas.
"""

import json
import re
import sys
from pathlib import Path

from docs import TABLES
from edgevox.agent.policy.policy import PolicyFile
from edgevox.ros2.robot_file.format import RobotFile
from edgevox.scenario import Scenario

ROOT = Path(__file__).resolve().parent.parent
SCHEMAS = {
    ROOT / "docs" / "scenario.schema.json": Scenario,
    ROOT / "docs" / "policy.schema.json": PolicyFile,
    ROOT / "docs" / "robot.schema.json": RobotFile,
}
ELSEWHERE = {"packages"}
"""What docs/render_architecture.py writes."""
BLOCK = re.compile(r"(<!-- generated: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def renewed(page: str) -> str:
    """The page with each generated part as it should be."""
    return BLOCK.sub(
        lambda found: found[1] + TABLES[found[2]]() + found[3] if found[2] in TABLES else found[0],
        page,
    )


def schemas() -> dict[Path, str]:
    """What editors and other programs need to know of the files that people write."""
    return {
        file: json.dumps(kind.model_json_schema(), indent=2, allow_nan=False) + "\n"
        for file, kind in SCHEMAS.items()
    }


def main(arguments: list[str]) -> int:
    """Run `write` or `check`; 2 for anything else."""
    pages = {page: page.read_text(encoding="utf-8") for page in (ROOT / "docs").glob("*.md")}
    there = {name for text in pages.values() for _, name, _ in BLOCK.findall(text)}
    if lost := TABLES.keys() ^ (there - ELSEWHERE):
        sys.stderr.write(f"docs: on no page, or made by nothing: {', '.join(sorted(lost))}\n")
        return 1
    wanted = {page: renewed(text) for page, text in pages.items()} | schemas()
    match arguments:
        case ["write"]:
            for file, text in wanted.items():
                file.write_text(text, encoding="utf-8")
            return 0
        case ["check"]:
            old = [
                file.name
                for file, text in wanted.items()
                if file.read_text(encoding="utf-8") != text
            ]
            for name in old:
                sys.stderr.write(f"{name}: not current; run scripts/reference.py write\n")
            return 1 if old else 0
    sys.stderr.write("usage: reference.py write|check\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
