"""How long a test waits for what should come, on whatever machine."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

HUNG_S = 600.0
"""Only something that hangs takes so long."""


def run_program(command: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """A program that came to its end, with what it printed; its input is empty unless given."""
    if "input" not in options:
        options["stdin"] = subprocess.DEVNULL
    return subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S, **options)
