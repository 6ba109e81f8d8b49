"""A PulseAudio server with a loudspeaker that nobody hears but the tests."""

import array
import os
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from waiting import wait_until

LOUD = 2000
"""Of 32768: more than any noise of a silent server."""
RATE_HZ = 16_000


class SoundServer:
    """Its socket lies in `folder`, and is a new one after each start."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.folder.mkdir()
        self._socket = folder / "native"
        self._home = folder.parent
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        command = ["pulseaudio", "-n", "--daemonize=no", "--exit-idle-time=-1"]
        command += ["--use-pid-file=no", "--log-target=stderr", "--load=module-null-sink"]
        command.append(f"--load=module-native-protocol-unix auth-anonymous=1 socket={self._socket}")
        own = {"HOME": str(self._home), "XDG_RUNTIME_DIR": str(self._home)}
        with (self._home / "pulseaudio.log").open("ab") as log:
            self._process = subprocess.Popen(command, env={**os.environ, **own}, stderr=log)
        wait_until(lambda: not self._asked("info").returncode, "a sound server")
        # It is the server's user's alone, which in a test is not the container's.
        self.folder.chmod(0o755)

    def stop(self) -> None:
        """As when it crashes."""
        if self._process:
            self._process.kill()
            self._process.wait()

    def streams(self) -> tuple[int, int]:
        """How many play on it and how many listen to it."""
        kinds = ("sink-inputs", "source-outputs")
        playing, listening = (self._asked("list", "short", kind).stdout for kind in kinds)
        return len(playing.splitlines()), len(listening.splitlines())

    @contextmanager
    def heard(self) -> Iterator[threading.Event]:
        """Set as soon as something loud is played."""
        loud = threading.Event()
        command = ["parec", f"--server={self._socket}", "--device=@DEFAULT_MONITOR@", "--raw"]
        command += ["--format=s16le", "--channels=1", f"--rate={RATE_HZ}", "--latency-msec=50"]
        recorder = subprocess.Popen(command, stdout=subprocess.PIPE)

        def listen() -> None:
            while block := recorder.stdout.read(RATE_HZ // 10 * 2):
                if max(map(abs, array.array("h", block[: len(block) // 2 * 2]))) > LOUD:
                    loud.set()

        thread = threading.Thread(target=listen, name="parec")
        thread.start()
        try:
            yield loud
        finally:
            recorder.kill()
            thread.join()
            recorder.wait()
            recorder.stdout.close()

    def _asked(self, *question: str) -> subprocess.CompletedProcess[str]:
        command = ["pactl", f"--server={self._socket}", *question]
        return subprocess.run(command, capture_output=True, text=True)


@contextmanager
def sound_server(folder: Path) -> Iterator[SoundServer]:
    """A running one, whose socket lies in a new folder of this name."""
    server = SoundServer(folder)
    server.start()
    try:
        yield server
    finally:
        server.stop()
