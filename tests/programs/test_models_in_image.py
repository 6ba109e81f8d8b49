"""What the Dockerfile copies before it fetches models is enough to fetch them."""

import os
import re
import shutil
import sys
from pathlib import Path

from guards import run_program

ROOT = Path(__file__).parents[2]
STAGE = re.compile(r"^FROM \S+ AS fetched\n(.*?)^FROM", re.DOTALL | re.MULTILINE)


def test_the_models_are_fetched_with_the_few_files_that_are_copied_for_it(tmp_path):
    (stage,) = STAGE.findall((ROOT / "Dockerfile.ros2").read_text())
    for line in re.findall(r"^COPY (.*)$", stage, re.MULTILINE):
        *sources, target = line.split()
        for source in sources:
            place = tmp_path / target.removeprefix("/src/")
            if (ROOT / source).is_dir():
                shutil.copytree(ROOT / source, place)
            else:
                place.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / source, place)

    told = run_program(
        [sys.executable, str(tmp_path / "docker" / "fetch_models"), str(tmp_path / "models")],
        env=os.environ | {"PYTHONPATH": str(tmp_path), "MODEL_SET": ""},
    )

    assert (told.returncode, told.stderr) == (0, "")
    assert (tmp_path / "models").is_dir()
