"""What a model on board takes of the machine: its GGUF file, checked, its memory and its threads.

Threads share the processor with the robot. Measured with Qwen2.5-Coder-0.5B Q4_K_M on two cores,
tokens/s of prompt and of answer, alone | beside a thread that wants 20 % of a core | beside one
that wants all of it:

    2 threads, OpenMP's own spinning    160, 45 | 46, 2.5 | 56, 14
    2 threads, no spinning (PASSIVE)    130, 28 | 102, 21 | 79, 26
    2 threads, GOMP_SPINCOUNT=1000      141, 44 | 110, 33 | 71, 19
    1 thread                             82, 29 |  82, 29 | 80, 29

A thread that waits by spinning burns the time slice that the thread it waits for needs; one that
sleeps at once pays a wake-up per matrix. A short spin keeps both the speed of two cores and the
robot's share, so all cores are used, with that.
"""

import math
import os
import resource
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.core.files.user_file import regular
from edgevox.core.process import memory_left, usable_cpus

_MAGIC = b"GGUF"
_SCALARS = {0: 1, 1: 1, 2: 2, 3: 2, 4: 4, 5: 4, 6: 4, 7: 1, 10: 8, 11: 8, 12: 8}
"""Bytes of each scalar type of a metadata value."""
_UINT32, _STRING, _ARRAY = 4, 8, 9
_LONGEST_STRING = 1 << 26
_MOST_DIMENSIONS = 4
_BYTES_PER_WEIGHT_AT_LEAST = 0.1
"""Below the densest quantisation that exists, so that a whole file is never called truncated."""


@dataclass(frozen=True, slots=True)
class Weights:
    """A whole file: its size, and what each token of context takes in memory, both in bytes."""

    size: int
    bytes_per_token: int


def check(path: Path) -> Weights:
    """The weights in a file. Raises `ModelFailed` if it is missing, not GGUF, or cut short."""
    try:
        size = path.stat().st_size
        with open(path, "rb", opener=regular) as file:
            if file.read(4) != _MAGIC:
                raise ModelFailed(f"{path}: not a GGUF model, its first bytes are not 'GGUF'")
            _version, tensors, values = _unpack(file, "<IQQ")
            numbers = _read_numbers(file, values)
            needed = _bytes_at_least(file, tensors)
    except FileNotFoundError:
        raise ModelFailed(f"{path}: there is no such model file") from None
    except OSError as error:
        raise ModelFailed(f"{path}: cannot be read: {error.strerror}") from None
    except (struct.error, ValueError, OverflowError):
        raise ModelFailed(f"{path}: truncated or damaged, its header does not read") from None
    if size < needed:
        raise ModelFailed(f"{path}: truncated, {size} bytes of at least {needed}; fetch it again")
    return Weights(size, _bytes_per_token(numbers))


def _bytes_per_token(numbers: Mapping[str, int]) -> int:
    """Keys and values of 16 bits in every layer; 0 where the header does not say."""
    heads = numbers.get("attention.head_count", 0)
    kept = numbers.get("attention.head_count_kv", heads)
    width = numbers.get("embedding_length", 0) // heads if heads else 0
    return 2 * 2 * numbers.get("block_count", 0) * kept * width


def _read_numbers(file: BinaryIO, values: int) -> dict[str, int]:
    """The whole numbers among the metadata, by their names without the architecture's."""
    numbers: dict[str, int] = {}
    for _ in range(values):
        name = _read_string(file).decode("utf-8", "replace").partition(".")[2]
        kind = _unpack(file, "<I")[0]
        if kind == _UINT32:
            numbers[name] = _unpack(file, "<I")[0]
        else:
            _skip_value(file, kind)
    return numbers


def _bytes_at_least(file: BinaryIO, tensors: int) -> int:
    """A lower bound of the file's size, from where its header says that the last tensor begins."""
    last_offset, last_weights = 0, 0
    for _ in range(tensors):
        _read_string(file)
        dimensions = _unpack(file, "<I")[0]
        if dimensions > _MOST_DIMENSIONS:
            raise ValueError(dimensions)
        weights = math.prod(_unpack(file, f"<{dimensions}Q"))
        _kind, offset = _unpack(file, "<IQ")
        if offset >= last_offset:
            last_offset, last_weights = offset, weights
    return file.tell() + last_offset + int(last_weights * _BYTES_PER_WEIGHT_AT_LEAST)


def _unpack(file: BinaryIO, layout: str) -> tuple[int, ...]:
    return struct.unpack(layout, file.read(struct.calcsize(layout)))


def _skip_string(file: BinaryIO) -> None:
    file.seek(_length(file), 1)


def _read_string(file: BinaryIO) -> bytes:
    return file.read(_length(file))


def _length(file: BinaryIO) -> int:
    length = _unpack(file, "<Q")[0]
    if length > _LONGEST_STRING:
        raise ValueError(length)
    return length


def _skip_value(file: BinaryIO, kind: int) -> None:
    if kind == _STRING:
        _skip_string(file)
    elif kind == _ARRAY:
        element, count = _unpack(file, "<IQ")
        if element in _SCALARS:
            file.seek(_SCALARS[element] * count, 1)
            return
        if element != _STRING:
            raise ValueError(element)
        for _ in range(count):
            _skip_string(file)
    elif kind in _SCALARS:
        file.seek(_SCALARS[kind], 1)
    else:
        raise ValueError(kind)


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
    """The memory that the kernel, the container and the process's limits allow; None if unknown."""
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
    """Bytes left under `ulimit -v`; None without such a limit."""
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if not 0 <= most < _NOBODY_NEEDS_MORE:
        return None
    taken = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return max(0, most - taken * resource.getpagesize())


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
