"""`edgevox-recorder` as the console starts it: it ends with the agent, however that ends."""

import os
import signal
import sys
import threading

from edgevox.apps.recorder import main as record


def main() -> int:
    """Run it; its exit code. It ends when its standard input does, which the agent holds."""
    threading.Thread(target=_end_with_agent, name="agent", daemon=True).start()
    return record()


def _end_with_agent() -> None:
    while os.read(sys.stdin.fileno(), 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)
