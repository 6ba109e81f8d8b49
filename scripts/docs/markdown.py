"""What all generated tables are written with."""

from collections.abc import Collection, Iterable


def table(
    heads: Iterable[str], rows: Iterable[Iterable[object]], right: Collection[str] = ()
) -> str:
    """A Markdown table; columns of numbers, under the heads in `right`, end at their right."""
    heads = tuple(heads)
    rules = tuple("---:" if head in right else "---" for head in heads)
    cells = ((str(cell).replace("|", "\\|") for cell in line) for line in (heads, rules, *rows))
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def first_line(docstring: str | None) -> str:
    """The first line of a docstring, or nothing."""
    return (docstring or "").partition("\n")[0]


def code(names: Iterable[object]) -> str:
    """Names as code, with commas between."""
    return ", ".join(f"`{name}`" for name in names)
