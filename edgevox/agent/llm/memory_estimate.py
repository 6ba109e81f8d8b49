"""What a language model takes of memory, and what there is: for its loader and for the doctor."""

import resource
from dataclasses import dataclass
from pathlib import Path

from edgevox.agent.llm.gguf import Weights
from edgevox.core.cgroup import memory_left

BUFFERS_BYTES = 160 << 20
"""Beside the weights and the cache of the context: the buffers of the engine."""
_NOBODY_NEEDS_MORE = 1 << 60


@dataclass(frozen=True, slots=True)
class Memory:
    """Bytes of the machine, and of those that may be taken now, without swapping.

    `limited_by` is what allows less than the machine has left; empty if nothing does.
    """

    total: int
    free: int
    limited_by: str = ""


def needed_bytes(weights: Weights, context_tokens: int) -> int:
    """About what it takes to load and to use them."""
    return weights.size + context_tokens * weights.bytes_per_token + BUFFERS_BYTES


def read_memory() -> Memory | None:
    """What the kernel can give, and the limits of container and process allow; None if unknown."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    read = {line.partition(":")[0]: int(line.split()[1]) * 1024 for line in lines}
    free = read["MemAvailable"]
    limits = {"a control group's limit": memory_left(), "ulimit -v": _address_space_left()}
    left = {name: most for name, most in limits.items() if most is not None and most < free}
    by = min(left, key=lambda name: left[name], default="")
    return Memory(read["MemTotal"], left.get(by, free), by)


def _address_space_left() -> int | None:
    """What `ulimit -v` allows; None where there is no such limit."""
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if not 0 <= most < _NOBODY_NEEDS_MORE:
        return None
    taken = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return max(0, most - taken * resource.getpagesize())
