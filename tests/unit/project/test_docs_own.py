"""The code that the page on skills shows is that of the examples, and it runs."""

import re
import textwrap
from pathlib import Path

from edgevox.agent.skills import OneOf, OwnName

ROOT = Path(__file__).parents[3]
BLOCKS = re.findall(
    r"^```python\n(.*?)^```",
    (ROOT / "docs" / "skills.md").read_text("utf-8"),
    re.MULTILINE | re.DOTALL,
)


def test_words_with_names_are_written_as_the_page_of_skills_writes_them():
    (block,) = (one for one in BLOCKS if "OwnName" in one)
    names = {"OneOf": OneOf, "OwnName": OwnName}
    exec(block, names)  # noqa: S102 - the page is ours

    assert names["MODES"].names["soft"]["de"] == OwnName("sanft", ("weich",))


def test_code_on_the_page_of_skills_is_that_of_the_examples():
    files = ("own_skill/watchman.py", "own_ros_skill/dock_hand.py")
    examples = "".join((ROOT / "examples" / file).read_text("utf-8") for file in files)
    blocks = [one for one in BLOCKS if "OwnName" not in one]
    assert len(blocks) == 1
    for block in blocks:
        assert block in examples or textwrap.indent(block, "    ") in examples
