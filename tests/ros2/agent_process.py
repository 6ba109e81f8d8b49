"""An edgevox-agent in a process of its own."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

from failed_subscribers import assert_none_in
from guards import HUNG_S
from process_memory import ProcessMemory, process_memory
from waiting import Heard, wait_until

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
HEARS_CTRL_C = ("env", "--default-signal=INT")
"""What a script starts in the background is deaf to Ctrl-C, and so are its children."""
READY = "is ready"
WITHOUT_ROS2 = """
import sys
for package in (
    "action_msgs", "builtin_interfaces", "diagnostic_msgs", "edgevox_msgs", "geometry_msgs",
    "nav_msgs", "rcl_interfaces", "rclpy", "sensor_msgs", "std_msgs", "std_srvs", "tf2_msgs",
):
    sys.modules[package] = None
from edgevox.apps.agent.main import main
sys.exit(main())
"""
"""The agent on a machine without ROS 2."""
MARGIN_MB = 25
"""What memory may differ by and be as before."""


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
        self.domain = domain
        self._told_to_leave = False
        self._printed = Heard[str]()
        self._reader = threading.Thread(target=self._read, name="agent-output")
        self._reader.start()

    @property
    def lines(self) -> list[str]:
        return self._printed.messages

    @property
    def output(self) -> str:
        return "\n".join(self.lines)

    def wait_for_line(self, text: str, timeout_s: float = HUNG_S, since: int = 0) -> str:
        """The first from number `since` on that holds this; fails loudly if none comes, or the
        program ends before.
        """
        return self._printed.wait_for(lambda line: text in line, timeout_s, since)

    def taken(self) -> ProcessMemory:
        """What it takes now."""
        return process_memory(self.process.pid)

    def takes_no_more_than(self, before: ProcessMemory, kept_mb: float = 0.0) -> None:
        """Wait until it has given back what it took since, but for what it may keep."""
        wait_until(lambda: self.taken().threads <= before.threads, "the threads of before")
        most_mb = before.rss_mb + kept_mb + MARGIN_MB
        try:
            wait_until(lambda: self.taken().rss_mb < most_mb, "the memory of before")
        except AssertionError:
            raise AssertionError(f"{before} became {self.taken()}, not {most_mb:.0f} MB") from None

    def leave(self) -> None:
        """Send SIGTERM, once; unless it has ended."""
        if not self._told_to_leave and self.process.poll() is None:
            self._told_to_leave = True
            self.process.send_signal(signal.SIGTERM)

    def terminate(self, timeout_s: float = HUNG_S) -> int:
        """Send SIGTERM and wait for the end; the exit code. No subscriber of its bus may fail."""
        self.leave()
        try:
            code = self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self._reader.join(timeout_s)
        assert_none_in(self.output)
        return code

    def _read(self) -> None:
        for line in self.process.stdout:
            self._printed.add(line.rstrip("\n"))
        self._printed.over()
