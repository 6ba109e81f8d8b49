"""The machine's hardware: memory, and a GPU if there is one.

The C library's allocator, set so that memory which is free goes back to the machine.

By itself glibc gives each thread a heap of its own, and takes what is large from those heaps, too,
once something large was ever freed. Messages of a megabyte that go through ten threads leave holes
in ten heaps: a node that was flooded with them grew by 30 MB a minute and never shrank.
"""

import ctypes
import os
import platform
from collections.abc import Mapping
from typing import Any

_M_MMAP_THRESHOLD, _M_ARENA_MAX = -3, -8
LARGE_BYTES = 256 * 1024
"""What is as large as this is mapped by itself, and unmapped when it is freed."""
HEAPS = 2


def return_memory() -> bool:
    """Set it for this process; call it before there are threads. False where that is not glibc.

    Who sets ``MALLOC_ARENA_MAX`` or ``MALLOC_MMAP_THRESHOLD_`` knows better.
    """
    wanted = (
        ("MALLOC_ARENA_MAX", _M_ARENA_MAX, HEAPS),
        ("MALLOC_MMAP_THRESHOLD_", _M_MMAP_THRESHOLD, LARGE_BYTES),
    )
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return False
    done = [mallopt(what, to) for name, what, to in wanted if name not in os.environ]
    return all(done)


_GIB = 2**30
_MIB = 2**20
_NO_GPU: Mapping[str, Any] = {
    "cuda": False,
    "gpu_name": None,
    "vram_total_gb": None,
    "vram_used_mb": None,
}


def hardware_info() -> dict[str, Any]:
    """What the machine has; the values of a GPU are null where there is none."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        **_first_gpu(),
        "metal": platform.system() == "Darwin" and platform.machine() == "arm64",
        "ram_gb": round(memory / _GIB, 1),
    }


def _first_gpu() -> Mapping[str, Any]:
    import pynvml

    try:
        pynvml.nvmlInit()
    except pynvml.NVMLError:
        return _NO_GPU
    try:
        gpu = pynvml.nvmlDeviceGetHandleByIndex(0)
        memory = pynvml.nvmlDeviceGetMemoryInfo(gpu)
        return {
            "cuda": True,
            "gpu_name": str(pynvml.nvmlDeviceGetName(gpu)),
            "vram_total_gb": round(int(memory.total) / _GIB, 1),
            "vram_used_mb": round(int(memory.used) / _MIB),
        }
    except pynvml.NVMLError:
        return _NO_GPU
    finally:
        pynvml.nvmlShutdown()
