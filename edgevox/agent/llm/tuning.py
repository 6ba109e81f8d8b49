"""Tuning of an engine that shares the processor with the robot.

Measured with Qwen2.5-Coder-0.5B Q4_K_M on two cores, tokens/s of prompt and of answer, alone |
beside a thread that wants 20 % of a core | beside one that wants all of it:

    2 threads, OpenMP's own spinning    160, 45 | 46, 2.5 | 56, 14
    2 threads, no spinning (PASSIVE)    130, 28 | 102, 21 | 79, 26
    2 threads, GOMP_SPINCOUNT=1000      141, 44 | 110, 33 | 71, 19
    1 thread                             82, 29 |  82, 29 | 80, 29

A thread that waits by spinning burns the time slice that the thread it waits for needs; one that
sleeps at once pays a wake-up per matrix. A short spin keeps both the speed of two cores and the
robot's share, so all cores are used, with that.
"""

import os

from edgevox.core.process import usable_cpus

SPIN_COUNT = 1000
BATCH_TOKENS = 32
"""Tokens of prompt that are read between two looks at the cancel token: a quarter of a second with
the small model on two cores. Batches of 512 read only some 10 % faster."""
MOST_THREADS = 8
"""More than these wait for memory, not for each other."""


def spin_briefly() -> None:
    """Tell OpenMP how long to spin; to be called before an engine's library is loaded.

    What the environment already says about waiting is left as it is.
    """
    if "OMP_WAIT_POLICY" not in os.environ:
        os.environ.setdefault("GOMP_SPINCOUNT", str(SPIN_COUNT))


def default_threads() -> int:
    """As many threads as this process may use cores, within reason."""
    return min(usable_cpus(), MOST_THREADS)
