"""A Fast DDS discovery server in a process of its own."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from waiting import wait_until


@contextmanager
def discovery_server(number: int, port: int, address: str = "127.0.0.1") -> Iterator[int]:
    """Its process id; the wheels' own program needs to be told where its libraries are."""
    prefix = Path(sys.prefix)
    folders = [*prefix.glob("lib/python3.*/site-packages/ros_*.libs"), prefix / "lib"]
    here = f"{prefix / 'bin'}{os.pathsep}{os.environ['PATH']}"
    libraries = os.pathsep.join([*map(str, folders), os.environ.get("LD_LIBRARY_PATH", "")])
    program = shutil.which("fast-discovery-server", path=here)
    assert program, "there is no fast-discovery-server beside ROS 2"
    command = [program, "-i", str(number), "-l", address, "-p", str(port)]
    given = {k: v for k, v in os.environ.items() if k != "ROS_DISCOVERY_SERVER"}
    with subprocess.Popen(
        command, env=given | {"LD_LIBRARY_PATH": libraries}, stdout=subprocess.DEVNULL
    ) as one:
        try:
            wait_until(lambda: _is_bound(port))
            yield one.pid
        finally:
            one.kill()


def _is_bound(port: int) -> bool:
    return bool(re.search(f":{port:04X} ", Path("/proc/net/udp").read_text("ascii")))
