"""Memory that is free goes back to the machine, whatever was large before."""

import os
import subprocess
import sys

PROGRAM = """
import ctypes, sys
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
libc.free.argtypes = [ctypes.c_void_p]
MB = 1 << 20

def own_mb():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("RssAnon")) / 1024

if sys.argv[1] == "set":
    from edgevox.ops.machine import return_memory
    assert return_memory()
libc.free(libc.malloc(16 * MB))  # from now on, by itself, nothing of that size is mapped
before, small, large = own_mb(), [], []
for _ in range(8):
    large.append(libc.malloc(8 * MB))
    ctypes.memset(large[-1], 1, 8 * MB)
    small.append(libc.malloc(1000))  # what stays, in between
for one in large:
    libc.free(one)
print(own_mb() - before)
"""


def grown_mb(how):
    clean = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, how], env=clean, capture_output=True, text=True, check=True
    )
    return float(done.stdout)


def test_holes_between_what_stays_are_given_back_only_as_it_is_set():
    assert grown_mb("as it is") > 40
    assert grown_mb("set") < 4
