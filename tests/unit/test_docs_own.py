"""What the pages on skills, robots and security say is what the examples and the code have."""

import re
import textwrap
from pathlib import Path
from typing import Protocol

import pytest

from edgevox.agent import skill_executor
from edgevox.agent.inbox import MAX_WAITING
from edgevox.agent.llm.endpoint import http_request
from edgevox.agent.nlu import interpreter
from edgevox.agent.skills import OneOf, OwnName
from edgevox.apps.terminal import lines
from edgevox.core import text, user_file
from edgevox.core.languages import LANGUAGES
from edgevox.ops import http_server
from edgevox.robots import capabilities, world
from edgevox.ros2 import skill_requests
from edgevox.ros2.external import locations
from edgevox.ros2.recorder import write_queue
from edgevox.scenario import scenario

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PACKAGE = ROOT / "edgevox"
ARCHITECTURE = DOCS / "architecture.md"


def code_on_the_page_of_skills() -> list[str]:
    page = (DOCS / "writing-a-skill.md").read_text()
    return re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)


def test_words_with_names_are_written_as_the_page_of_skills_writes_them():
    (block,) = (one for one in code_on_the_page_of_skills() if "OwnName" in one)
    names = {"OneOf": OneOf, "OwnName": OwnName}
    exec(block, names)  # noqa: S102 - the page is ours

    assert names["MODES"].names["soft"]["de"] == OwnName("sanft", ("weich",))


def test_code_on_the_page_of_skills_is_that_of_the_examples():
    files = ("own_skill/watchman.py", "own_ros_skill/dock_hand.py")
    examples = "".join((ROOT / "examples" / file).read_text() for file in files)
    blocks = [one for one in code_on_the_page_of_skills() if "OwnName" not in one]
    assert len(blocks) == 4
    for block in blocks:
        assert block in examples or textwrap.indent(block, "    ") in examples


def test_the_page_of_robots_has_every_protocol_with_its_methods():
    page = (DOCS / "bringing-a-robot.md").read_text()
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    protocols = {
        name: protocol
        for name, protocol in vars(capabilities).items()
        if isinstance(protocol, type) and issubclass(protocol, Protocol)
        if protocol.__module__ == capabilities.__name__ and name != "Body"
    }
    assert len(protocols) > 10
    for name, protocol in protocols.items():
        (row,) = (row for row in rows if f"`{name}`" in row)
        own = {one for one in vars(protocol) if not one.startswith("_")}
        for one in own | set(protocol.__annotations__):
            assert f"`{one}`" in row, (name, one)


@pytest.mark.parametrize(
    ("told", "number"),
    [
        ("{:,} characters", text.MAX_CHARACTERS),
        ("sentences that wait: {}", MAX_WAITING),
        ("calls in one sentence: {}", skill_executor.MAX_CALLS),
        ("{} MB, of which", lines.MAX_LINE_BYTES >> 20),
        ("{} KB |", skill_requests.MAX_ARGUMENTS_BYTES >> 10),
        ("| {} KB, 2 s", http_server.MOST_BYTES >> 10),
        ("2 s, {} at once", http_server.MOST_AT_ONCE),
        ("reply | {} MB", http_request.MOST_BYTES >> 20),
        ("{} tokens", interpreter.ANSWER_TOKENS),
        ("{:,} steps", scenario.MAX_STEPS),
        ("{:,} things", world.MOST_THINGS),
        ("{} places", locations.MOST_LOCATIONS),
        ("names | {} MB", user_file.LARGEST_TEXT_BYTES // 1_000_000),
        ("{:,} messages", write_queue.MOST_MESSAGES),
        ("or {} MB that wait", write_queue.MOST_BYTES >> 20),
    ],
)
def test_a_bound_on_the_page_of_security_is_that_of_the_code(told, number):
    assert told.format(number) in (DOCS / "security.md").read_text()


def test_every_path_on_the_page_of_the_architecture_leads_to_a_file():
    told = re.findall(r"`([\w.*-]+/[\w./*-]*)`", ARCHITECTURE.read_text())
    assert len(told) > 100
    lost = [one for one in told if not ([*PACKAGE.glob(one)] or [*ROOT.glob(one)])]
    assert lost == []


def test_the_page_of_the_architecture_has_a_place_for_every_file_of_the_package():
    rows = re.findall(r"^\| (`\w[\w/]*/`.*?) \| (.*) \|$", ARCHITECTURE.read_text(), re.MULTILINE)
    told = set()
    for folders, files in rows:
        names = set(re.findall(r"`(\w+)`", files))
        for folder in re.findall(r"`([\w/]+)/`", folders):
            here = {one.stem for one in (PACKAGE / folder).iterdir()}
            told |= {f"{folder}/{name}.py" for name in names & here}
            names -= here
        assert names == set(), f"no such file in {folders}"
    files = {one.relative_to(PACKAGE).as_posix() for one in PACKAGE.rglob("*.py")}
    assert {one for one in files - told if not one.endswith("__init__.py")} == set()


def test_the_table_of_folders_names_every_folder():
    table = re.findall(r"^\| (`.*?) \|", (ROOT / "CONTRIBUTING.md").read_text(), re.MULTILINE)
    named = {Path(one).parts[0] for row in table for one in re.findall(r"`([^`]+)`", row)}
    ignored = {one.strip("/") for one in (ROOT / ".gitignore").read_text().splitlines()}
    there = {one.name for one in ROOT.iterdir() if one.is_dir() and one.name[0] not in "._"}
    assert there - ignored - named == set()


@pytest.mark.parametrize("code", sorted(LANGUAGES.keys() - {"en"}))
def test_the_page_of_languages_names_every_file_that_has_an_entry_for_each(code):
    page = (DOCS / "adding-a-language.md").read_text()
    files = re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE)
    assert len(files) == 4
    for name in files:
        path = ROOT / name.replace("CODE", code)
        text = path.read_text("utf-8")
        entry = rf"^\[?{code}[\]:.]"
        assert "CODE" in name or re.search(entry, text, re.MULTILINE), name
