"""The page's files as a browser on a slow network wants them.

They are read and compressed once, and served below a name made of their content, so that a browser
keeps them for good: a changed page has other addresses. The document names all modules that the
page begins with, and a browser fetches them at once instead of one import after the other.
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
        for name in content:
            if name.endswith(".html"):
                content[name] = self._with_addresses(name, content)
        self._files = {name: _file(name, data) for name, data in content.items()}

    def add_to(self, router: web.UrlDispatcher) -> None:
        """Serve all of them."""
        router.add_get(_STATIC + "{name:.+}", self._static)

    def document(self, request: web.Request, name: str) -> web.Response:
        """Answer with a file by its own address. Raises 404 where there is no such file."""
        return self._answer(request, name, kept=False)

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
        headers = {"Content-Type": file.type, "Vary": "Accept-Encoding"}
        if kept:
            headers["Cache-Control"] = _KEPT
        body = file.plain
        if file.compressed and "gzip" in request.headers.get("Accept-Encoding", ""):
            headers["Content-Encoding"] = "gzip"
            body = file.compressed
        return web.Response(body=body, headers=headers)

    def _with_addresses(self, name: str, content: dict[str, bytes]) -> bytes:
        """A document whose files are named by their content, with the modules that it begins."""
        here = f"{_STATIC}{self._version}/"
        text = content[name].decode("utf-8").replace(_STATIC, here)
        for script in re.findall(rf'<script type="module" src="{here}([\w./]+)"', text):
            links = (
                f'<link rel="modulepreload" href="{here}{one}">\n'
                for one in _imported(script, content)
            )
            text = text.replace("<script type", "".join(links) + "<script type", 1)
        return text.encode("utf-8")


def _imported(module: str, content: dict[str, bytes]) -> list[str]:
    """A module and all that it imports, each once, the nearest first."""
    found = [module]
    for one in found:
        for named in _IMPORT.findall(content[one].decode("utf-8")):
            other = str(PurePosixPath(one).parent / "".join(named))
            if other not in found:
                found.append(other)
    return found


def _file(name: str, data: bytes) -> _File:
    kind = PurePosixPath(name).suffix
    small = gzip.compress(data, 9, mtime=0) if kind in _COMPRESSED else data
    known = _TYPES.get(kind) or mimetypes.guess_type(name)[0] or "application/octet-stream"
    text = known.startswith("text/") or kind in (".json", ".svg")
    return _File(data, small if len(small) < len(data) else None, known + "; charset=utf-8" * text)
