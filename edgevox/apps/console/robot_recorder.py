"""Recordings that somebody begins and ends on the console: `edgevox-recorder` beside the agent."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.ros2.contract import RECORDER_NODE

log = get_logger(__name__)

LONGEST_S = 3600.0
"""One that is forgotten ends by itself."""
MB = 1_000_000
SPARE_MB, NEEDED_MB = 500, 1000
"""What is left to others, and what must be free to begin."""
MOST_FILE_MB = 100_000
"""A recording is one file."""
PROGRAM = "from edgevox.apps.recorder import main; raise SystemExit(main())"
_ENCLAVE, _KEYSTORE = "ROS_SECURITY_ENCLAVE_OVERRIDE", "ROS_SECURITY_KEYSTORE"


def open_recorder(
    settings: Settings, folder: Path, environment: Mapping[str, str] = os.environ
) -> "RobotRecorder | None":
    """A recorder for what this agent says on ROS 2; None where it could hear nothing of it."""
    if not settings.ros2 or not all(map(find_spec, ("rclpy", "mcap"))):
        return None
    given = dict(environment)
    if given.get("ROS_SECURITY_ENABLE") == "true":
        enclave = f"{settings.agent_namespace.rstrip('/')}/{RECORDER_NODE}"
        if not (Path(given.get(_KEYSTORE, "")) / "enclaves" / enclave[1:]).is_dir():
            return None
        given[_ENCLAVE] = enclave
    return RobotRecorder(settings, folder / "recordings", given)


class RobotRecorder:
    """At most one recording at a time. Each is a folder with one MCAP file. Any thread."""

    def __init__(self, settings: Settings, folder: Path, environment: Mapping[str, str]) -> None:
        self.folder = folder
        self._leave_s = settings.leave_s
        self.environment = environment
        self._command = [
            *(sys.executable, "-P", "-c", PROGRAM, "--output", str(folder)),
            *("--agent-namespace", settings.agent_namespace),
            *("--duration", f"{LONGEST_S:g}", "--spare", str(SPARE_MB)),
            *("--max-size", str(MOST_FILE_MB)),
            *("--health-port", "0", "--metrics-port", "0"),  # the agent's are taken
        ]
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._since_s = 0.0
        self._earlier: frozenset[Path] = frozenset()
        self._why = ""

    def start(self) -> None:
        """Begin a recording. Raises `EdgeVoxError`."""
        with self._lock:
            if self._process:
                raise EdgeVoxError("record: it records already")
            self._make_room()
            self._earlier = frozenset(self.folder.iterdir())
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=dict(self.environment),
                text=True,
                errors="replace",
            )
            self._since_s, self._why = time.monotonic(), ""
            log.info("console_recording_begun", folder=str(self.folder))
            watch = threading.Thread(
                target=self._watch, args=(self._process,), name="console-recorder", daemon=True
            )
            watch.start()

    def stop(self) -> None:
        """End it, and wait until its file is whole; nothing where there is none."""
        with self._lock:
            process = self._process
        if process is None:
            return
        process.terminate()
        try:
            process.wait(2 * self._leave_s)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        with self._lock:
            self._ended(process)

    def delete(self, name: str) -> None:
        """Remove the recording of this file. Raises `EdgeVoxError`."""
        for file in self.files():
            if file.name == name:
                shutil.rmtree(file.parent)
                return
        raise EdgeVoxError(f"record: {name!r} is no recording")

    def files(self) -> Sequence[Path]:
        """Those that are over, the newest first."""
        with self._lock:
            hidden = self._process is not None
            earlier = self._earlier
        found = [
            one
            for one in self.folder.glob("edgevox-*/*.mcap")
            if not hidden or one.parent in earlier
        ]
        return sorted(found, key=lambda file: file.name, reverse=True)

    def state(self) -> Mapping[str, Any]:
        """As pages are told it: whether it records and for how long, what there is to take."""
        with self._lock:
            running = self._process is not None
            seconds, why = time.monotonic() - self._since_s, self._why
        files = []
        for one in self.files():
            with suppress(FileNotFoundError):  # it was deleted just now
                files.append({"name": one.name, "bytes": one.stat().st_size})
        told: dict[str, Any] = {"running": running, "files": files, "why": why}
        return told | ({"seconds": seconds} if running else {})

    def _make_room(self) -> None:
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            free_mb = shutil.disk_usage(self.folder).free / MB
        except OSError as error:
            raise EdgeVoxError(f"record: {self.folder}: {error.strerror or error}") from None
        if free_mb < NEEDED_MB:
            raise EdgeVoxError(f"record: {free_mb:.0f} MB of disk are free, expected {NEEDED_MB}")

    def _watch(self, process: subprocess.Popen[str]) -> None:
        last = _last_line(process.stderr) if process.stderr else ""
        code = process.wait()
        failed = code not in (0, -signal.SIGTERM)  # it may be stopped before it listens for that
        with self._lock:
            self._ended(process)
            if failed:
                self._why = last or f"it ended with {code}"
        if failed:
            log.warning("console_recording_failed", code=code, reason=last)
        else:
            log.info("console_recording_ended", folder=str(self.folder))

    def _ended(self, process: subprocess.Popen[str]) -> None:
        if self._process is process:
            self._process = None


def _last_line(stream: IO[str]) -> str:
    last = ""
    with stream:
        for line in stream:
            last = line.strip() or last
    return last
