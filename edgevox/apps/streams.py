"""Standard input, output and error, made fit for a robot before anything else happens.

They are there, though the program was started without them; they take every language, though the
locale knows ASCII only; and what cannot be written to them is lost, instead of the work.
"""

import codecs
import errno
import io
import os
import sys
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TextIO, cast

from edgevox.core.files.text import printable
from edgevox.core.process import OutputStream, Tell

P = ParamSpec("P")
FAILED = 1


def with_streams(
    program: str, *, results: bool = False
) -> Callable[[Callable[P, int]], Callable[P, int]]:
    """Wrap the `main` of a program. Streams that somebody else put in place are left alone.

    Output that could not be written is told once on the log, and the program goes on. With
    `results` the output is what the program is for: then it waits for whoever reads, and it fails
    in one line if the output is lost, unless its reader simply left, as `head` does.
    """

    def around(main: Callable[P, int]) -> Callable[P, int]:
        @wraps(main)
        def started(*args: P.args, **kwargs: P.kwargs) -> int:
            lost: list[str] = []
            open_streams(lambda error: _tell(program, error, lost), waits=results)
            code = main(*args, **kwargs)
            sys.stdout.flush()
            if not (results and lost):
                return code
            show(f"{program}: standard output: {lost[0]}", error=True)
            return code or FAILED

        return started

    return around


def show(text: str, *, error: bool = False) -> None:
    """Print this for the person at the terminal: the one way there for all programs here.

    It may have several lines. What of it is another's has gone through `one_line` before, else it
    could look like a line of ours; nothing in it steers the terminal.
    """
    print(printable(text), file=sys.stderr if error else sys.stdout, flush=True)


def open_streams(tell: Tell, *, waits: bool) -> None:
    """Make this process's streams fit; `tell` hears of standard output that cannot be written."""
    if sys.stdin is sys.__stdin__:
        sys.stdin = sys.stdin or _nobody("r")
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(encoding=_encoding(sys.stdin), errors="replace")
    if sys.stdout is sys.__stdout__:
        sys.stdout = _guarded(sys.stdout, tell, waits=waits)
    if sys.stderr is sys.__stderr__:
        sys.stderr = _guarded(sys.stderr, lambda _: None, waits=waits, by_line=True)


def _guarded(stream: TextIO | None, tell: Tell, *, waits: bool, by_line: bool = False) -> TextIO:
    if stream is None:
        return _nobody("w")
    raw = OutputStream(stream.fileno(), tell, waits=waits)
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=_encoding(stream),
        errors="backslashreplace" if by_line else "replace",
        line_buffering=by_line or raw.isatty(),
    )


def _nobody(mode: str) -> TextIO:
    """Open a substitute for a closed stream: else the next file would get its number."""
    return cast("TextIO", open(os.devnull, mode, encoding="utf-8"))


def _encoding(stream: TextIO) -> str:
    """Return its own encoding, unless that is ASCII, which cannot hold what people say."""
    return "utf-8" if codecs.lookup(stream.encoding).name == "ascii" else stream.encoding


def _tell(program: str, error: OSError, lost: list[str]) -> None:
    from edgevox.core.log import get_logger

    reason = error.strerror or str(error)
    if error.errno != errno.EPIPE:
        lost.append(reason)
    log = get_logger(__name__)
    log.warning("output_lost", program=program, reason=reason)
