"""The types of all pages, which have no build step: in comments, checked by TypeScript."""

import subprocess
from pathlib import Path

from browser_rig import MODULES

ROOT = Path(__file__).parents[2]


def test_the_types_of_all_pages_are_right() -> None:
    told = subprocess.run(
        [MODULES / ".bin/tsc", "--listFiles", "--project", ROOT / "requirements/page"],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert told.returncode == 0, told.stdout
    for page in ("edgevox/console/page/main.js", "edgevox/apps/fleet/page/fleet.js"):
        assert str(ROOT / page) in told.stdout.splitlines()
