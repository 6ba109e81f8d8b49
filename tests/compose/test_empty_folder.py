"""docs/your-robot.md, "From an empty folder": its command works in a copy of the example."""

import re
import shutil

import pytest
from guards import run_program
from stacks import ROOT

pytestmark = pytest.mark.long

PAGE = (ROOT / "docs" / "your-robot.md").read_text("utf-8")
PART = re.search(r"^## From an empty folder\n.*?(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[0]


def test_a_scenario_of_the_copied_example_comes_true(image, tmp_path):
    folder = tmp_path / "ours"
    shutil.copytree(ROOT / "examples" / "robot_repository", folder)
    tmp_path.chmod(0o755)
    (command,) = re.findall(r"^```bash\n(.*?)^```$", PART, re.MULTILINE | re.DOTALL)
    command = command.replace("edgevox-ros2:local", image)
    ran = run_program(["bash", "-euc", command], cwd=folder)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "PASSED" in ran.stdout
