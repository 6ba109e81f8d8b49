"""Small stand-ins, on this machine, for the places that models come from."""

import base64
import hashlib
import io
import json
import subprocess
import tarfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

CLOSED = "http://127.0.0.1:9"
"""Nobody listens there."""


@contextmanager
def serving(handler: type[BaseHTTPRequestHandler]) -> Iterator[str]:
    """An HTTP server on this machine; its address."""
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = Thread(target=server.serve_forever, args=(0.01,), name="place")
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def tarball(members: Mapping[str, bytes]) -> bytes:
    """An npm package: its files lie below ``package/``."""
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w:gz") as tar:
        for name, data in members.items():
            about = tarfile.TarInfo(f"package/{name}")
            about.size = len(data)
            tar.addfile(about, io.BytesIO(data))
    return out.getvalue()


def npm_registry(package: str, version: str, packed: bytes) -> type[BaseHTTPRequestHandler]:
    """A registry that has one version of one package."""
    integrity = base64.b64encode(hashlib.sha512(packed).digest()).decode()

    class Registry(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            host = f"http://{self.headers['Host']}"
            dist = {"tarball": f"{host}/{package}.tgz", "integrity": f"sha512-{integrity}"}
            one = {"name": package, "version": version, "dist": dist}
            about = {"name": package, "dist-tags": {"latest": version}, "versions": {version: one}}
            pages = {f"/{package}": json.dumps(about).encode(), f"/{package}.tgz": packed}
            page = pages.get(self.path)
            self.send_response(200 if page else 404)
            self.send_header("Content-Length", str(len(page or b"")))
            self.end_headers()
            self.wfile.write(page or b"")

        def log_message(self, *_: object) -> None: ...

    return Registry


class Repository:
    """A git repository with a working tree, and a bare copy that can be fetched from."""

    def __init__(self, folder: Path) -> None:
        self.tree, self.bare = folder / "tree", folder / "bare.git"
        self.tree.mkdir(parents=True)
        self._git("init", "--quiet")

    @property
    def url(self) -> str:
        return self.bare.as_uri()

    def commit(self, change: Callable[[Path], object]) -> str:
        """Change the tree and publish it; the commit's name."""
        change(self.tree)
        self._git("add", "--all")
        self._git("-c", "user.name=us", "-c", "user.email=us@example.org", "commit", "-qm", "x")
        if not self.bare.exists():
            self._git("clone", "--quiet", "--bare", ".", str(self.bare))
            for setting in ("allowFilter", "allowAnySHA1InWant"):
                self._git("--git-dir", str(self.bare), "config", f"uploadpack.{setting}", "true")
        self._git("push", "--quiet", "--force", str(self.bare), "HEAD")
        return self._git("rev-parse", "HEAD").strip()

    def _git(self, *arguments: str) -> str:
        command = ["git", *arguments]
        return subprocess.run(
            command, cwd=self.tree, check=True, capture_output=True, text=True
        ).stdout


def writing(files: Mapping[str, bytes]) -> Callable[[Path], None]:
    """A change that writes these files."""

    def write(folder: Path) -> None:
        for name, data in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    return write
