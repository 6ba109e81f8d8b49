"""A probe in a process of its own, which may hang or die: a finding, and not the end.

``python -m edgevox.core.probe MODULE:FUNCTION`` is that process. The probe's arguments follow on
its command line. Its facts are the last line on standard output; output of libraries goes to
standard error.
"""

import importlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from typing import Any

from edgevox.core.errors import EdgeVoxError

PROBE_S = 60.0
"""A probe that takes longer hangs."""
_LAST = 300


class ProbeFailed(EdgeVoxError):
    """A probe in a process of its own came to no end, or to a bad one."""


def probe_apart(
    address: str,
    *arguments: str,
    environment: Mapping[str, str] | None = None,
    timeout_s: float = PROBE_S,
) -> Mapping[str, Any]:
    """Run a probe in its own process, in this environment or another; return its facts.

    Raises `ProbeFailed`.
    """
    command = [sys.executable, "-P", "-m", "edgevox.core.probe", address, *arguments]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            env=environment,
            timeout=timeout_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ProbeFailed(f"it hangs: no answer within {timeout_s:g} s") from None
    if done.returncode < 0:
        name = signal.Signals(-done.returncode).name
        raise ProbeFailed(f"it ended the process with {name}{_last_line(done.stderr)}")
    if done.returncode:
        raise ProbeFailed(f"it failed{_last_line(done.stderr)}")
    facts: Mapping[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return facts


def _last_line(output: bytes) -> str:
    lines = output.decode(errors="replace").strip().splitlines()
    return f": {lines[-1][:_LAST]}" if lines else ""


def _main(address: str, *arguments: str) -> None:
    """Probe, and print what was seen."""
    answers = os.dup(1)
    os.dup2(2, 1)
    module, _, function = address.partition(":")
    facts = getattr(importlib.import_module(module), function)(*arguments)
    os.write(answers, json.dumps(facts).encode() + b"\n")
    os.close(answers)


if __name__ == "__main__":
    _main(*sys.argv[1:])
