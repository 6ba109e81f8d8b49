"""The documentation as a site: whole, strict, and readable without any network."""

import json
import os
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pytest
from guards import run_program

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
LOADS = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src"}


class References(HTMLParser):
    """What a page loads by itself, where it leads, and its anchors."""

    def __init__(self, text):
        super().__init__()
        self.loaded, self.led, self.anchors = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.add(values.get("id"))
        if tag in LOADS and values.get(LOADS[tag]) and values.get("rel") != "canonical":
            self.loaded.append(values[LOADS[tag]])
        if tag == "a" and values.get("href"):
            self.led.append(values["href"])


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    done = run_program(
        [Path(sys.executable).with_name("mkdocs"), "build", "--strict", "--site-dir", folder],
        cwd=ROOT,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
    )
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site):
    return {page: References(page.read_text()) for page in site.rglob("*.html")}


def test_every_page_of_the_folder_is_on_the_site(site):
    for page in (ROOT / "docs").glob("*.md"):
        assert (site / page.with_suffix(".html").name).is_file()


def test_nothing_is_loaded_from_elsewhere(site, pages):
    for page, references in pages.items():
        if page.name == "404.html":  # a server's, which knows its root
            continue
        for address in references.loaded:
            assert "//" not in address, (page.name, address)
            assert (page.parent / urldefrag(unquote(address))[0]).is_file(), (page.name, address)
    for sheet in site.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", sheet.read_text()), sheet


def test_every_link_leads_to_a_file_and_an_anchor_that_are_there(pages):
    for page, references in pages.items():
        if page.name == "404.html":
            continue
        for address in references.led:
            if "://" in address or address.startswith("javascript:"):
                assert re.match(r"https://|http://localhost:\d+$", address), (page.name, address)
                continue
            path, anchor = urldefrag(unquote(address))
            target = (page.parent / path).resolve() if path else page.resolve()
            assert target.is_file(), (page.name, address)
            if anchor and target.suffix == ".html":
                assert anchor in pages[target].anchors, (page.name, address)


def test_the_search_knows_all_pages_without_a_server(site):
    text = (site / "search" / "search_index.js").read_text()
    index = json.loads(text.partition("=")[2])
    found = {urldefrag(one["location"])[0] for one in index["docs"]}
    assert {page.with_suffix(".html").name for page in (ROOT / "docs").glob("*.md")} <= found


def test_a_file_of_the_repository_that_is_linked_is_shown(site):
    shown = (site / "source" / "examples" / "own_robot" / "shuttle.py.html").read_text()
    assert "class" in shown
    assert "Shuttle" in shown
