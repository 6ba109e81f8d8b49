"""Files of Python as syntax trees, for tests of how code is written."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path


def trees(folder: Path, having: str) -> Iterator[tuple[Path, ast.Module]]:
    """The files under a folder, in order, in whose text this pattern is found: to parse all takes
    seconds.
    """
    for file in sorted(folder.rglob("*.py")):
        text = file.read_text(encoding="utf-8")
        if re.search(having, text):
            yield file, ast.parse(text)
