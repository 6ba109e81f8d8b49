"""The table of docs/architecture.md: what lives in which folder, in each folder's own words."""

import ast
import re
from pathlib import Path

from docs.markdown import table

PACKAGE = Path(__file__).resolve().parents[2] / "edgevox"


def folders() -> str:
    """Every folder inside a package, with the first sentence of its docstring."""
    files = sorted(PACKAGE.glob("*/*/**/__init__.py"))
    rows = ((f"`{file.parent.relative_to(PACKAGE)}`", _sentence(file)) for file in files)
    return table(("folder", "what lives there"), rows)


def _sentence(file: Path) -> str:
    docstring = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return re.split(r"\.(?:\s|$)", " ".join(docstring.split()))[0].replace("``", "`")
