"""What MkDocs does besides: files of the repository that a page links to become pages of the site.

Pages link to sources as they do on a code host: `../examples/own_robot/shuttle.py`. On the site
such a link leads to a page under `source/` that shows the file: the site is whole by itself.
"""

import posixpath
import re
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parent.parent
SHOWN = "source"
"""The folder of the site in which files of the repository are shown."""
ALWAYS = (
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "helm/edgevox/README.md",
    "training/README.md",
    "training/adapter/README.md",
    "training/spotter/README.md",
)
"""Those that stand in the navigation."""
LANGUAGES = {".yml": "yaml", ".py": "python", ".sh": "bash", ".schema": "json"}
HIDDEN = "---\nsearch:\n  exclude: true\n---\n\n"

_CODE = re.compile(r"`[^`\n]+`")
_LINK = re.compile(r"(?<=\]\()(?!\w+:|#)([^)\s#]+)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for every file that is linked to, and for those that these link to."""
    waiting = [*ALWAYS]
    for file in files.documentation_pages():
        waiting += _links(file.content_string, file.src_uri)
    while waiting:
        path = waiting.pop()
        uri = _site_uri(path)
        if path.startswith("docs/") or files.get_file_from_path(uri) or not (ROOT / path).exists():
            continue
        text = _shown(path)
        files.append(File.generated(config, uri, content=text))
        if uri.endswith(("/index.md", path)):  # a page or a folder, and no code
            waiting += _links(text, uri)
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Lead links to files of the repository to the pages that show them.

    Code hosts want a bar within code in a table escaped, Python's Markdown does not.
    """
    uri = page.file.src_uri
    here = posixpath.dirname(uri)

    def led(link: re.Match[str]) -> str:
        path = _path(link[1], uri)
        if not (ROOT / path).exists():
            return link[1]  # MkDocs says that it leads nowhere
        return posixpath.relpath(_site_uri(path), here or ".")

    return _CODE.sub(lambda code: code[0].replace("\\|", "|"), _LINK.sub(led, markdown))


def _links(text: str, uri: str) -> list[str]:
    """What a page of the site links to, as paths in the repository."""
    return [_path(link, uri) for link in _LINK.findall(text)]


def _path(link: str, uri: str) -> str:
    """What a link of this page means in the repository."""
    inside = uri.removeprefix(f"{SHOWN}/")
    folder = posixpath.dirname(inside if inside != uri else f"docs/{uri}")
    return posixpath.normpath(posixpath.join(folder, link))


def _site_uri(path: str) -> str:
    """Where the site has a file of the repository."""
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    if (ROOT / path).is_dir():
        return f"{SHOWN}/{path}/index.md"
    return f"{SHOWN}/{path}" if path.endswith(".md") else f"{SHOWN}/{path}.md"


def _shown(path: str) -> str:
    """A page with the contents of a file or a folder."""
    file = ROOT / path
    if file.is_dir():
        names = sorted(one.name for one in file.iterdir() if one.is_file())
        return f"{HIDDEN}# {path}\n\n" + "".join(f"- [{name}]({name})\n" for name in names)
    text = file.read_text(encoding="utf-8")
    if path.endswith(".md"):
        return text
    suffix = PurePosixPath(path).suffix
    language = LANGUAGES.get(suffix, suffix.lstrip("."))
    return f"{HIDDEN}# {path}\n\n``````{language}\n{text.rstrip()}\n``````\n"
