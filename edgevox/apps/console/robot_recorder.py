"""Recordings that a person starts and stops on the console: `edgevox-recorder` beside the agent."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from edgevox.core.errors import EdgeVoxError
from edgevox.core.files.user_file import size_bytes
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status
from edgevox.ros2.contract import RECORDER_NODE
from edgevox.ros2.recordings import begun, finished, folders, opened, remove, used_bytes
from edgevox.security.startup import ENABLE, ENCLAVE, KEYSTORE, OVERRIDE, ROS_KEYSTORE

log = get_logger(__name__)


MB = 1_000_000
SPARE_MB = 500
"""Disk space that is left to others."""


class KeptRecordings:
    """A folder with one of its own for each recording. Any thread; nothing goes by itself.

    A file is offered once it is whole, which its name says.

    most_bytes: how many all recordings have together at most.
    """

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self.folder = folder
        self._most_bytes = most_bytes

    def make_folder(self) -> int:
        """Have the folder; the bytes that a new recording has room for. Raises `EdgeVoxError`."""
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            return self._room()
        except OSError as error:
            raise EdgeVoxError(f"record: {self.folder}: {error.strerror or error}") from None

    def room(self) -> int:
        """Return the bytes that are left for recordings.

        Below 0 if there are too many, 0 if unknown.
        """
        try:
            return self._room()
        except OSError:
            return 0

    def begun_bytes(self) -> int:
        """Return the size of the current recording."""
        return sum(
            size_bytes(one) for folder in folders(self.folder)[-1:] for one in opened(folder)
        )

    def files(self) -> Sequence[Path]:
        """Return the complete recordings, the newest first."""
        return [
            one for folder in reversed(folders(self.folder)) for one in reversed(finished(folder))
        ]

    def unfinished(self) -> bool:
        """Whether there are files that are written, or were left unfinished."""
        return any(opened(folder) for folder in folders(self.folder))

    def told(self) -> list[Mapping[str, Any]]:
        """The same as pages are told it: name, bytes, and when it was begun if that is known."""
        found: list[Mapping[str, Any]] = []
        for one in self.files():
            with suppress(FileNotFoundError):  # it was deleted just now
                found.append(
                    {"name": one.name, "bytes": one.stat().st_size, "begun": begun(one.parent)}
                )
        return found

    def delete(self, name: str) -> None:
        """Remove the recording of this file. Raises `EdgeVoxError`."""
        for file in self.files():
            if file.name == name:
                remove(file)
                return
        raise EdgeVoxError(f"record: {name!r} is no recording")

    def _room(self) -> int:
        near = next(one for one in (self.folder, *self.folder.parents) if one.exists())
        free = shutil.disk_usage(near).free - SPARE_MB * MB
        return min(free, self._most_bytes - used_bytes(self.folder))


LONGEST_S = 3600.0
"""A forgotten recording ends after this."""
LEAST_MB = 50
"""Space that a recording needs to begin; a smaller bound in the settings is enough."""
MOST_FILE_MB = 10_000_000
"""A recording is one file, whatever the settings allow it."""
PROGRAM = "from edgevox.apps.recorder import main_under_agent; raise SystemExit(main_under_agent())"


class NoRecorder(StrEnum):
    """The missing part without which an agent cannot be recorded, as pages get it."""

    ROS2 = "ros2"
    EXTRA = "extra"
    ENCLAVE = "enclave"


def open_recorder(
    settings: Settings, folder: Path, environment: Mapping[str, str] = os.environ
) -> "RobotRecorder | NoRecorder":
    """A recorder for what this agent says on ROS 2, or why it could hear nothing of it."""
    if not settings.ros2 or not find_spec("rclpy"):
        return NoRecorder.ROS2
    if not find_spec("mcap"):
        return NoRecorder.EXTRA
    given = dict(environment)
    if given.get(ENABLE) == "true":
        enclave = f"{settings.agent_namespace.rstrip('/')}/{RECORDER_NODE}"
        if not (Path(given.get(ROS_KEYSTORE, "")) / "enclaves" / enclave[1:]).is_dir():
            return NoRecorder.ENCLAVE
        given[OVERRIDE] = enclave
        if given.get(KEYSTORE):
            given[ENCLAVE] = enclave
    return RobotRecorder(settings, folder, given)


class RobotRecorder:
    """At most one recording at a time; each is a folder with one MCAP file. For any thread."""

    name = ComponentName.RECORDINGS
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, settings: Settings, folder: Path, environment: Mapping[str, str]) -> None:
        self.kept = KeptRecordings(folder, settings.console_recordings_mb * MB)
        self.environment = environment
        self._least_mb = min(LEAST_MB, settings.console_recordings_mb)
        self._leave_s = settings.leave_s
        self._program = [sys.executable, "-P", "-c", PROGRAM, "--output", str(folder)]
        self._command = [
            *self._program,
            *("--agent-namespace", settings.agent_namespace),
            *("--duration", f"{LONGEST_S:g}", "--spare", str(SPARE_MB)),
            *("--max-size", str(MOST_FILE_MB)),
            *("--health-port", "0", "--metrics-port", "0"),  # the agent's are taken
        ]
        self._lock = threading.Lock()
        self._listeners: list[Callable[[bool], None]] = []
        self._process: subprocess.Popen[str] | None = None
        self._mender: subprocess.Popen[bytes] | None = None
        self._since_s = 0.0
        self._why = ""

    @property
    def running(self) -> bool:
        """Whether it records now."""
        with self._lock:
            return self._process is not None

    def listen(self, listener: Callable[[bool], None]) -> Callable[[], object]:
        """Call it, on any thread, with `running` when that changes. Returns what ends that."""
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener)

    def mend(self) -> None:
        """Have the files mended that an earlier agent left unfinished. Raises `OSError`."""
        if self.kept.unfinished():
            self._mender = subprocess.Popen(
                [*self._program, "--mend"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                env=dict(self.environment),
            )

    def close(self) -> None:
        """End what it records; mending goes on at the next start."""
        self.stop()
        if self._mender:
            self._mender.terminate()
            with self._mender:
                pass

    def start(self) -> None:
        """Begin a recording. Raises `EdgeVoxError`, `OSError`."""
        with self._lock:
            if self._process:
                raise EdgeVoxError("record: it records already")
            room = self.kept.make_folder()
            if room // MB < self._least_mb:
                raise EdgeVoxError(f"record: room for {room // MB} MB, expected {self._least_mb}")
            most = used_bytes(self.kept.folder) + room
            process = self._process = subprocess.Popen(
                [*self._command, "--most", f"{most / MB:g}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=dict(self.environment),
                text=True,
                errors="replace",
            )
            self._since_s, self._why = time.monotonic(), ""
        log.info("console_recording_begun", folder=str(self.kept.folder))
        self._tell()
        threading.Thread(
            target=self._watch, args=(process,), name="console-recorder", daemon=True
        ).start()

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
        self._ended(process)

    def delete(self, name: str) -> None:
        """Remove the recording of this file. Raises `EdgeVoxError`."""
        self.kept.delete(name)

    def files(self) -> Sequence[Path]:
        """Return the complete recordings, the newest first."""
        return self.kept.files()

    def state(self) -> Mapping[str, Any]:
        """Return the state for pages.

        Whether and how long it records, and the files to download.
        """
        with self._lock:
            running = self._process is not None
            seconds, why = time.monotonic() - self._since_s, self._why
        room = self.kept.room()
        told: dict[str, Any] = {
            "running": running,
            "room": room,
            "full": room < (0 if running else self._least_mb * MB),
            "files": self.kept.told(),
            "why": why,
        }
        if running:
            told |= {"seconds": seconds, "bytes": self.kept.begun_bytes()}
        return told

    def status(self) -> Status:
        """The status: a recording that failed or has no room is a warning."""
        with self._lock:
            running, why = self._process is not None, self._why
        room = self.kept.room()
        findings = [Finding(Level.WARN, f"the last recording failed: {why}")] if why else []
        if room < (0 if running else self._least_mb * MB):
            findings.append(Finding(Level.WARN, "no room for a recording"))
        return Status.judged(
            self.name,
            findings,
            well="records" if running else "does not record",
            recording=running,
            room_mb=room // MB,
        )

    def _watch(self, process: subprocess.Popen[str]) -> None:
        last = _last_line(process.stderr) if process.stderr else ""
        code = process.wait()
        if process.stdin:
            process.stdin.close()
        failed = code not in (0, -signal.SIGTERM)  # it may be stopped before it listens for that
        self._ended(process, (last or f"it ended with {code}") if failed else "")
        if failed:
            log.warning("console_recording_failed", code=code, reason=last)
        else:
            log.info("console_recording_ended", folder=str(self.kept.folder))

    def _ended(self, process: subprocess.Popen[str], why: str = "") -> None:
        with self._lock:
            its = self._process is process
            if its:
                self._process = None
            if its or not self._process:  # the next one is not told what became of this one
                self._why = why or self._why
        if its:
            self._tell()

    def _tell(self) -> None:
        running = self.running
        for listener in tuple(self._listeners):
            listener(running)


def _last_line(stream: IO[str]) -> str:
    last = ""
    with stream:
        for line in stream:
            last = line.strip() or last
    return last
