"""The page's files as a browser on a slow network wants them.

They are read and compressed once, and served below a name made of their content, so that a browser
keeps them for good: a changed page has other addresses. The document names all modules that the
page begins with, and a browser fetches them at once instead of one import after the other. Its
style sheets are one, and the words of the browser's language come with it.
"""

import gzip
import hashlib
import mimetypes
import re
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from aiohttp import web

PAGE = Path(__file__).parent / "page"
_STATIC = "/static/"
_KEPT = "public, max-age=31536000, immutable"
_IMPORT = re.compile(r'^import [^;]*?"(\./[\w./]+)";|import\("(\./[\w./]+)"\)', re.MULTILINE)
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STYLES = re.compile(rf'(?:<link rel="stylesheet" href="{_STATIC}[^"]+">\s*)+')
_STYLE = re.compile(rf'href="{_STATIC}([^"]+)"')
_WORDS = "languages/"
_COMPRESSED = (".css", ".html", ".js", ".json", ".svg", ".webmanifest")
_TYPES = {".js": "text/javascript", ".webmanifest": "application/manifest+json"}


@dataclass(frozen=True)
class _File:
    plain: bytes
    compressed: bytes | None
    """With gzip; None where that does not make it smaller."""
    type: str


class PageFiles:
    """The files of a page's folder, as they are now. Empty where there is no such folder."""

    def __init__(self, folder: Path = PAGE) -> None:
        read = {str(file.relative_to(folder)): file for file in sorted(folder.rglob("*"))}
        content = {name: file.read_bytes() for name, file in read.items() if file.is_file()}
        digest = hashlib.sha256()
        for name, data in content.items():
            digest.update(f"{name} {len(data)} ".encode() + data)
        self._version = digest.hexdigest()[:16]
        for name in [one for one in content if one.endswith(".html")]:
            content[name] = self._with_addresses(name, content)
        self._files = {name: _file(name, data) for name, data in content.items()}
        self._documents: dict[tuple[str, str, bool], _File] = {}

    def add_to(self, router: web.UrlDispatcher) -> None:
        """Serve all of them."""
        router.add_get(_STATIC + "{name:.+}", self._static)

    def document(self, request: web.Request, name: str, *, paired: bool = False) -> web.Response:
        """Answer with a document in the browser's language, which is told whether it is let in.

        Raises 404 where there is no such file.
        """
        if name not in self._files:
            raise web.HTTPNotFound
        key = name, self._language(request.headers.get("Accept-Language", "")), paired
        if key not in self._documents:
            self._documents[key] = self._document(*key)
        return _response(request, self._documents[key], kept=False)

    def _document(self, name: str, language: str, paired: bool) -> _File:
        text = self._files[name].plain.decode("utf-8")
        if paired:
            text = text.replace("<html ", "<html data-paired ", 1)
        if words := self._files.get(f"{_WORDS}{language}.json"):
            told = words.plain.decode("utf-8").replace("<", "\\u003c")
            given = f'<script type="application/json" id="words" lang="{language}">{told}</script>'
            text = text.replace("</body>", f"{given}</body>", 1)
        return _file(name, text.encode("utf-8"))

    def _language(self, accepted: str) -> str:
        """The first language that the browser wants and there are words in; else English.

        Empty where there are no words at all.
        """
        wanted = [one.strip().partition(";")[0].partition("-")[0] for one in accepted.split(",")]
        known = (one for one in (*wanted, "en") if f"{_WORDS}{one}.json" in self._files)
        return next(known, "")

    async def _static(self, request: web.Request) -> web.Response:
        name = request.match_info["name"]
        version, _, rest = name.partition("/")
        if version == self._version:
            return self._answer(request, rest, kept=True)
        return self._answer(request, name, kept=False)

    def _answer(self, request: web.Request, name: str, *, kept: bool) -> web.Response:
        file = self._files.get(name)
        if file is None:
            raise web.HTTPNotFound
        return _response(request, file, kept=kept)

    def _with_addresses(self, name: str, content: dict[str, bytes]) -> bytes:
        """A document whose files are named by their content, with the modules that it begins."""
        here = f"{_STATIC}{self._version}/"
        text = _STYLES.sub(
            lambda styles: _joined(styles[0], content), content[name].decode("utf-8")
        )
        text = text.replace(_STATIC, here)
        for script in re.findall(rf'<script type="module"[^>]* src="{here}([\w./]+)"', text):
            links = (
                f'<link rel="modulepreload" href="{here}{one}">\n'
                for one in _imported(script, content)
            )
            text = text.replace("<script type", "".join(links) + "<script type", 1)
        return text.encode("utf-8")


def _joined(styles: str, content: dict[str, bytes]) -> str:
    """One link for these; what it names is added to the content."""
    names = _STYLE.findall(styles)
    if len(names) == 1:
        return styles
    joined = f"{PurePosixPath(names[0]).parent}/all.css"
    content[joined] = b"\n".join(content[one] for one in names)
    return f'<link rel="stylesheet" href="{_STATIC}{joined}">\n'


def _imported(module: str, content: dict[str, bytes]) -> list[str]:
    """A module and all that it imports, each once, the nearest first."""
    found = [module]
    for one in found:
        for named in _IMPORT.findall(_COMMENT.sub("", content[one].decode("utf-8"))):
            other = str(PurePosixPath(one).parent / "".join(named))
            if other not in found:
                found.append(other)
    return found


def _response(request: web.Request, file: _File, *, kept: bool) -> web.Response:
    headers = {"Content-Type": file.type, "Vary": "Accept-Encoding"}
    if kept:
        headers["Cache-Control"] = _KEPT
    body = file.plain
    if file.compressed and "gzip" in request.headers.get("Accept-Encoding", ""):
        headers["Content-Encoding"] = "gzip"
        body = file.compressed
    return web.Response(body=body, headers=headers)


def _file(name: str, data: bytes) -> _File:
    kind = PurePosixPath(name).suffix
    small = gzip.compress(data, 9, mtime=0) if kind in _COMPRESSED else data
    known = _TYPES.get(kind) or mimetypes.guess_type(name)[0] or "application/octet-stream"
    text = known.startswith("text/") or kind in (".json", ".svg")
    return _File(data, small if len(small) < len(data) else None, known + "; charset=utf-8" * text)
