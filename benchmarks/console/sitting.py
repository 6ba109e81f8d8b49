"""What a console keeps of pages that come and go: memory, threads, open files, by a line's slope.

    python -m benchmarks.console.console --sitting MINUTES

The server is in this process and the browsers are in another one, which opens pages, looks at the
robot and leaves, over and over. The first third is warming up and does not count.
"""

import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from console_rig import console

from edgevox.console.sessions import Role

LOOK_S = 1.0
PAGE_KB = os.sysconf("SC_PAGE_SIZE") / 1024
PAGES = Path(__file__).with_name("pages.py")


def sitting(minutes: float) -> Iterator[str]:
    """Lines that say how much each grew by a thousand pages, with twice its standard error."""
    with tempfile.TemporaryDirectory() as folder, console(Path(folder)) as rig:
        code = rig.server.offer_code(Role.VIEWER)[0].code
        program = [sys.executable, str(PAGES), rig.server.url, code]
        with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as goers:
            seen = _watch(60.0 * minutes)
            goers.terminate()
            assert goers.stdout is not None
            pages = len(goers.stdout.read())
    counted = seen[len(seen) // 3 :]
    yield f"{minutes:g} minutes, {pages} pages came and went"
    thousand_s = 60.0 * minutes * 1000 / max(pages, 1)
    for number, (name, unit) in enumerate((("memory", "kB"), ("threads", ""), ("files", ""))):
        slope, error = _line(counted[:, 0], counted[:, 1 + number])
        yield (
            f"{name}: {counted[0, 1 + number]:.0f} to {counted[-1, 1 + number]:.0f} {unit}, "
            f"by a thousand pages {thousand_s * slope:+.2f} ± {2 * thousand_s * error:.2f} {unit}"
        )


def _watch(seconds: float) -> np.ndarray:
    """Rows of seconds, resident kB, threads and open files."""
    began_s, rows = time.monotonic(), []
    while (at_s := time.monotonic() - began_s) < seconds:
        pages = int(Path("/proc/self/statm").read_text("utf-8").split()[1])
        files = len(os.listdir("/proc/self/fd"))
        rows.append((at_s, pages * PAGE_KB, threading.active_count(), files))
        time.sleep(LOOK_S)
    return np.array(rows)


def _line(at_s: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Slope a second, and its standard error."""
    (slope, _), covariance = np.polyfit(at_s, values, 1, cov=True)
    return float(slope), float(np.sqrt(covariance[0, 0]))
