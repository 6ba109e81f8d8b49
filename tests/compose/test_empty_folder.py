"""docs/your-robot.md, "From an empty folder": what each part says works in an empty folder."""

import re

import pytest
from guards import run_program
from stacks import ROOT

pytestmark = pytest.mark.long

PAGE = (ROOT / "docs" / "your-robot.md").read_text("utf-8")
PART = re.search(r"^## From an empty folder\n.*?(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[0]
SECTIONS = {
    part.partition("\n")[0]: part for part in re.split(r"^### ", PART, flags=re.MULTILINE)[1:]
}
FILE = re.compile(r"^`(robot/[\w./-]+)`[^\n]*:\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^```bash\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("title", SECTIONS)
def test_what_a_section_says_works_in_an_empty_folder(title, image, tmp_path):
    tmp_path.chmod(0o755)
    files = FILE.findall(SECTIONS[title])
    assert files
    for name, text in files:
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    (command,) = COMMAND.findall(SECTIONS[title])
    command = command.replace("edgevox-ros2:local", image)
    ran = run_program(["bash", "-euc", command], cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "PASSED" in ran.stdout


def test_it_begins_with_a_scenario_for_the_ci():
    assert list(SECTIONS) == ["A scenario for your CI"]
