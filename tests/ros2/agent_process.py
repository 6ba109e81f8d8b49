"""An edgevox-agent in a process of its own."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

from guards import HUNG_S

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
HEARS_CTRL_C = ("env", "--default-signal=INT")
"""What a script starts in the background is deaf to Ctrl-C, and so are its children."""
READY = "is ready"


class Agent:
    """A running edgevox-agent, with what it printed."""

    def __init__(
        self,
        *arguments: str,
        domain: int,
        stdin: int = subprocess.DEVNULL,
        program: str = AGENT,
    ) -> None:
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }
        self.process = subprocess.Popen(
            [*HEARS_CTRL_C, program, *arguments],
            stdin=stdin,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=environment,
            text=True,
        )
        self.lines: list[str] = []
        self._arrived = threading.Condition()
        self._reader = threading.Thread(target=self._read, name="agent-output")
        self._reader.start()

    @property
    def output(self) -> str:
        return "\n".join(self.lines)

    def wait_for_line(self, text: str, timeout_s: float = HUNG_S) -> str:
        def found() -> list[str]:
            return [line for line in self.lines if text in line]

        with self._arrived:
            self._arrived.wait_for(lambda: found() or self._ended(), timeout_s)
            assert found(), f"{text!r} was not printed; the output was:\n{self.output}"
            return found()[0]

    def terminate(self, timeout_s: float = HUNG_S) -> int:
        """Send SIGTERM and wait for the end; the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self._reader.join(timeout_s)

    def _ended(self) -> bool:
        return self.process.poll() is not None and not self._reader.is_alive()

    def _read(self) -> None:
        for line in self.process.stdout:
            with self._arrived:
                self.lines.append(line.rstrip("\n"))
                self._arrived.notify_all()
        with self._arrived:
            self._arrived.notify_all()
