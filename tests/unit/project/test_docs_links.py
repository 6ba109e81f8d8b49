"""Every page's links and pictures lead somewhere."""

import itertools
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PAGES = [
    page
    for folder in ("", "docs", "benchmarks", "helm/*", "tests", "training", "training/*")
    for page in ROOT.glob(f"{folder}/*.md".lstrip("/"))
]
LARGEST_PICTURE_BYTES = 200_000
OF_OURS = r"(?<![\w/.~$-])[\w*-][\w.*-]*/[\w./*-]*\.(?:py|toml|ya?ml)\b"
FOLDERS = [ROOT / name for name in (".", "edgevox", "tests", "compose/observability")]
"""Where paths on pages begin."""


GIVEN = r"`[^`\n]+`[^\n]*:\n\n"
"""The name of a file whose text the page itself has, for the reader to write."""


def anchors(page):
    """The headings of a page as a browser names them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_somewhere(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if "://" in link:
            assert re.match(r"https://[a-z0-9-]+(\.[a-z0-9-]+)+(/|$)", link), link
            continue
        name, _, anchor = link.partition("#")
        target = page.parent / name if name else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_of_ours_that_a_page_names_is_there(page):
    text = re.sub(rf"^({GIVEN})?```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    quoted = " ".join(re.findall(r"`([^`\n]+)`", text))
    for name in re.findall(OF_OURS, quoted):
        pattern = name.replace("CODE", "*")
        assert any([*folder.glob(pattern)] for folder in (page.parent, *FOLDERS)), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_list_begins_after_an_empty_line_as_the_site_needs_it(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    for before, line in itertools.pairwise(text.splitlines()):
        begins = re.match(r"(?:[-*]|\d+\.) ", line)
        assert not begins or re.match(r"\s*$|(?:[-*]|\d+\.) |\s", before), line


def test_the_front_door_leads_to_every_page():
    start = (ROOT / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")}
    assert pages - set(re.findall(r"\]\(docs/([\w-]+\.md)", start)) == set()


def test_every_picture_is_shown_somewhere_and_is_small():
    shown = {name for page in PAGES for name in re.findall(r"images/([\w.-]+)", page.read_text())}
    for picture in (ROOT / "docs" / "images").iterdir():
        assert picture.name in shown, picture.name
        assert picture.stat().st_size <= LARGEST_PICTURE_BYTES, picture.name
