"""An edgevox-agent in a process of its own."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

from guards import HUNG_S
from waiting import Heard

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
        self._printed = Heard[str]()
        self._reader = threading.Thread(target=self._read, name="agent-output")
        self._reader.start()

    @property
    def lines(self) -> list[str]:
        return self._printed.messages

    @property
    def output(self) -> str:
        return "\n".join(self.lines)

    def wait_for_line(self, text: str, timeout_s: float = HUNG_S) -> str:
        """The first that holds this; fails loudly if none comes, or the program ends before."""
        return self._printed.wait_for(lambda line: text in line, timeout_s)

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

    def _read(self) -> None:
        for line in self.process.stdout:
            self._printed.add(line.rstrip("\n"))
        self._printed.over()
