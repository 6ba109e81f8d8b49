"""How the page's files come to a browser: small, kept for good, and all at once."""

import asyncio
import gzip
import json
import re
from pathlib import Path

import pytest
from aiohttp import web
from aiohttp.test_utils import make_mocked_request

from edgevox.console.page_files import PAGE, PageFiles


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    (tmp_path / "index.html").write_text('<script type="module" src="/static/first.js"></script>')
    (tmp_path / "first.js").write_text('import { b } from "./b.js";\nimport("./parts/late.js");\n')
    (tmp_path / "b.js").write_text("export const b = 1;\n" * 50)
    (tmp_path / "parts" / "late.js").write_text("1;\n")
    (tmp_path / "sign.bin").write_bytes(b"\x00\x01")
    return tmp_path


def got(files: PageFiles, name: str, accepts: str = "") -> web.Response:
    request = make_mocked_request("GET", f"/{name}", {"Accept-Encoding": accepts})
    return files.document(request, name)


def addresses(files: PageFiles) -> list[str]:
    document = got(files, "index.html").body
    assert isinstance(document, bytes)
    return re.findall(r'(?:href|src)="([^"]+)"', document.decode())


def test_a_document_names_all_modules_that_it_begins_with_below_their_content(folder: Path) -> None:
    first = addresses(PageFiles(folder))
    assert [one.split("/", 3)[3] for one in first] == [
        "first.js",
        "b.js",
        "parts/late.js",
        "first.js",
    ]
    assert addresses(PageFiles(folder)) == first
    (folder / "b.js").write_text("export const b = 2;\n")
    assert not set(addresses(PageFiles(folder))) & set(first)


def test_style_sheets_come_as_one_in_their_order(tmp_path: Path) -> None:
    sheets = '<link rel="stylesheet" href="/static/style/{}.css">\n'
    (tmp_path / "index.html").write_text(sheets.format("b") + sheets.format("a"))
    (tmp_path / "style").mkdir()
    for name in "ab":
        (tmp_path / "style" / f"{name}.css").write_text(name)
    files = PageFiles(tmp_path)
    (address,) = addresses(files)
    assert asyncio.run(answered(files, address)).body == b"b\na"


@pytest.mark.parametrize(
    ("accepted", "lang"),
    [("de-DE,de;q=0.9,en;q=0.8", "de"), ("xx, en", "en"), ("xx", "en"), ("", "en")],
)
def test_the_words_of_the_browsers_language_or_english_come_with_the_document(
    folder: Path, accepted: str, lang: str
) -> None:
    (folder / "index.html").write_text("<html lang='en'><body></body></html>")
    (folder / "languages").mkdir()
    for name in ("de", "en"):
        (folder / "languages" / f"{name}.json").write_text('{"a": "</script>"}')
    files = PageFiles(folder)
    request = make_mocked_request("GET", "/", {"Accept-Language": accepted})
    body = files.document(request, "index.html", paired=True).body
    assert isinstance(body, bytes)
    assert b"<html data-paired " in body
    found = re.findall(rb'id="words" lang="(\w+)">(.*)</script>', body)
    assert [one.decode() for one, _ in found] == [lang]
    assert all(json.loads(words) == {"a": "</script>"} for _, words in found)
    assert b"</script>" not in b"".join(words for _, words in found)
    assert b"data-paired" not in (got(files, "index.html").body or b"")


def test_text_is_compressed_for_who_takes_it(folder: Path) -> None:
    files = PageFiles(folder)
    plain, small = got(files, "b.js"), got(files, "b.js", "br, gzip")
    assert plain.body == (folder / "b.js").read_bytes()
    assert isinstance(small.body, bytes)
    assert gzip.decompress(small.body) == plain.body
    assert small.headers["Content-Encoding"] == "gzip"
    assert small.headers["Content-Type"] == "text/javascript; charset=utf-8"
    assert "Content-Encoding" not in got(files, "sign.bin", "gzip").headers


async def answered(files: PageFiles, address: str) -> web.Response:
    app = web.Application()
    files.add_to(app.router)
    request = make_mocked_request("GET", address)
    found = await app.router.resolve(request)
    request._match_info = found  # noqa: SLF001 - as the server does
    return await found.handler(request)


@pytest.mark.parametrize("name", ["nothing.js", "", "../site.py", "%2e%2e/site.py"])
def test_what_is_not_of_the_page_is_not_found(folder: Path, name: str) -> None:
    with pytest.raises(web.HTTPNotFound):
        got(PageFiles(folder), name)


def test_by_the_address_of_its_content_a_file_is_kept_and_by_another_it_is_not(
    folder: Path,
) -> None:
    files = PageFiles(folder)
    kept = asyncio.run(answered(files, addresses(files)[0]))
    assert kept.headers["Cache-Control"] == "public, max-age=31536000, immutable"
    assert "Cache-Control" not in asyncio.run(answered(files, "/static/first.js")).headers
    with pytest.raises(web.HTTPNotFound):
        asyncio.run(answered(files, "/static/0123456789abcdef/first.js"))


def test_the_page_itself_begins_with_few_files() -> None:
    """Over HTTP/1.1 a browser fetches six at once: each six more are another way there and back."""
    assert len(addresses(PageFiles(PAGE))) <= 22
