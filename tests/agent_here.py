"""`edgevox-agent` without a process of its own, which costs seconds of computing each time."""

import io
import os
import signal
import sys
import tempfile
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from unittest.mock import patch

from edgevox.apps.agent.main import main

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass(frozen=True)
class Done:
    """How it ended, and what it wrote: named as those of `subprocess.run`."""

    returncode: int
    stdout: str
    stderr: str


def run_agent(*arguments: str, said: str | bytes = b"") -> Done:
    """Run it to its end with these lines in a file at its standard input."""
    with ExitStack() as stack:
        lines = stack.enter_context(tempfile.TemporaryFile())
        lines.write(said.encode() if isinstance(said, str) else said)
        lines.seek(0)
        stack.enter_context(patch.dict(os.environ))
        for one in SIGNALS:  # both are a process's own: what it changes ends with it
            stack.callback(signal.signal, one, signal.getsignal(one))
        stack.enter_context(patch.object(sys, "stdin", lines))
        out = stack.enter_context(redirect_stdout(io.StringIO()))
        errors = stack.enter_context(redirect_stderr(io.StringIO()))
        try:
            code = main(arguments)
        except SystemExit as ended:  # by the parser of its arguments
            code = int(ended.code or 0)
        return Done(code, out.getvalue(), errors.getvalue())
