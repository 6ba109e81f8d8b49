"""The machine's hardware: memory, and a GPU if there is one."""

import os
import platform
from collections.abc import Mapping
from typing import Any

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
