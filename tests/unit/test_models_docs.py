"""What docs/models.md says of the sets is what the manifest says."""

import re
from pathlib import Path

import pytest

from edgevox.models.manifest import builtin_manifest

DOC = (Path(__file__).parents[2] / "docs" / "models.md").read_text()
ROWS = dict(re.findall(r"^\| `([\w-]+)` \|.*\| (\d+) MB \|.*$", DOC, re.MULTILINE))


def test_every_set_has_a_row_and_every_row_is_a_set() -> None:
    assert set(ROWS) == set(builtin_manifest().sets)


@pytest.mark.parametrize("name", builtin_manifest().sets)
def test_the_size_of_a_set_is_told_truly(name: str) -> None:
    size = sum(model.size for model in builtin_manifest().select([name]))

    assert int(ROWS[name]) == round(size / 1e6)


def test_the_example_of_an_entry_names_only_fields_that_exist() -> None:
    example = DOC.partition("```toml")[2].partition("```")[0]
    fields = re.findall(r"^(\w+) =", example, re.MULTILINE)

    assert set(fields) <= set(next(iter(builtin_manifest().models.values())).model_dump())
