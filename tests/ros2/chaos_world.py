"""What the chaos plays with around the node: a model server, model files, peers that are killed."""

import json
import os
import random
import shutil
import subprocess
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from lease import SHORT_LEASE

from edgevox.models import locate

FLOODER = str(Path(__file__).with_name("chaos_flooder.py"))
MODELS = ("qwen2.5-coder-0.5b-instruct", "piper-en_US-joe-medium", "whisper-tiny.en")
OTHERS = ("whisper-base",)
"""Of another language: they may vanish too."""


class ModelServer:
    """An OpenAI-compatible server on one port that dies, comes back, and behaves as it is told."""

    MOODS = ("good", "garbage", "silent", "broken", "slow", "half")

    def __init__(self) -> None:
        self.mood = "good"
        self._over = threading.Event()
        self._http: ThreadingHTTPServer | None = None
        self._thread: threading.Thread | None = None
        self.port = 0
        self.live()

    @property
    def alive(self) -> bool:
        return self._http is not None

    def live(self) -> None:
        self._over.clear()
        self._http = ThreadingHTTPServer(("127.0.0.1", self.port), self._handler())
        self._http.daemon_threads = True
        self.port = self._http.server_port
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.05,))
        self._thread.start()

    def die(self) -> None:
        self._over.set()
        if self._http and self._thread:
            self._http.shutdown()
            self._http.server_close()
            self._thread.join()
        self._http = None

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        over = self._over

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, *_: object) -> None:
                """The journal has what matters."""

            def do_GET(self) -> None:
                self._reply(200, json.dumps({"data": [{"id": "tiny", "owned_by": "chaos"}]}))

            def do_POST(self) -> None:
                self.rfile.read(int(self.headers.get("Content-Length", 0)))
                try:
                    getattr(self, f"_{server.mood}")()
                except OSError:
                    """Nobody waits any more."""

            def _reply(self, status: int, body: str = "", kind: str = "application/json") -> None:
                self.send_response(status)
                self.send_header("Content-Type", kind)
                self.end_headers()
                self._raw(body)

            def _raw(self, text: str) -> None:
                self.wfile.write(text.encode())
                self.wfile.flush()

            def _piece(self, text: str) -> None:
                choice = {"index": 0, "delta": {"content": text}, "finish_reason": None}
                self._raw(f"data: {json.dumps({'choices': [choice]})}\n\n")

            def _good(self) -> None:
                self._reply(200, kind="text/event-stream")
                for piece in ("talk: ", "So ", "be ", "it."):
                    self._piece(piece)
                self._raw("data: [DONE]\n\n")

            def _slow(self) -> None:
                self._reply(200, kind="text/event-stream")
                for piece in ("talk: ", *("and " for _ in range(30))):
                    self._piece(piece)
                    over.wait(0.2)
                self._raw("data: [DONE]\n\n")

            def _half(self) -> None:
                self._reply(200, kind="text/event-stream")
                self._piece("talk: I was about")

            def _garbage(self) -> None:
                self._reply(200, "\x00{]" * 2000)

            def _broken(self) -> None:
                self._reply(503, "out of order")

            def _silent(self) -> None:
                over.wait(10)

        return Handler


class ModelFiles:
    """A models folder of links to the real files, which can vanish and come back."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._gone: list[tuple[Path, Path]] = []
        for name in (*MODELS, *OTHERS):
            place = locate(name)
            real = place if place.is_dir() else place.parent
            for file in real.rglob("*"):
                if file.is_file():
                    self._link(file, root / name / file.relative_to(real))

    def vanish(self, rng: random.Random) -> str:
        """One file is gone."""
        links = sorted(one for one in self.root.rglob("*") if one.is_symlink())
        if not links:
            return "nothing is left"
        link = rng.choice(links)
        self._gone.append((link, link.resolve()))
        link.unlink()
        return str(link.relative_to(self.root))

    def restore(self) -> None:
        """All are there again."""
        for link, real in self._gone:
            if not link.exists():
                link.symlink_to(real)
        self._gone.clear()

    @staticmethod
    def _link(file: Path, link: Path) -> None:
        link.parent.mkdir(parents=True, exist_ok=True)
        if file.name.startswith("."):
            shutil.copy2(file, link)  # the stamps: what is linked was verified
        else:
            link.symlink_to(file)


class Killed:
    """Peers in processes of their own, each killed without a word when its time has come."""

    def __init__(self, domain: int) -> None:
        self._environment = {**os.environ, **SHORT_LEASE, "ROS_DOMAIN_ID": str(domain)}
        self._running: list[tuple[subprocess.Popen[bytes], float]] = []
        self.killed = 0

    def start(self, what: str, lives_s: float) -> bool:
        """Start one, unless two run already."""
        self.look()
        if len(self._running) >= 2:
            return False
        process = subprocess.Popen([sys.executable, FLOODER, what], env=self._environment)
        self._running.append((process, time.monotonic() + lives_s))
        return True

    def look(self) -> None:
        """Kill those whose time has come."""
        now_s = time.monotonic()
        for process, until_s in list(self._running):
            if now_s >= until_s or process.poll() is not None:
                self._kill(process)
                self._running.remove((process, until_s))

    def close(self) -> None:
        for process, _ in self._running:
            self._kill(process)
        self._running.clear()

    def _kill(self, process: subprocess.Popen[bytes]) -> None:
        process.kill()
        process.wait()
        self.killed += 1
