"""What a GGUF file promises about itself, read before an engine is trusted with it."""

import math
import struct
from pathlib import Path
from typing import BinaryIO

from edgevox.agent.llm.base import ModelFailed

_MAGIC = b"GGUF"
_SCALARS = {0: 1, 1: 1, 2: 2, 3: 2, 4: 4, 5: 4, 6: 4, 7: 1, 10: 8, 11: 8, 12: 8}
"""Bytes of each scalar type of a metadata value."""
_STRING, _ARRAY = 8, 9
_LONGEST_STRING = 1 << 26
_MOST_DIMENSIONS = 4
_BYTES_PER_WEIGHT_AT_LEAST = 0.1
"""Below the densest quantisation that exists, so that a whole file is never called truncated."""


def check(path: Path) -> int:
    """The file's size in bytes. Raises `ModelFailed` if it is missing, not GGUF, or cut short."""
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            if file.read(4) != _MAGIC:
                raise ModelFailed(f"{path}: not a GGUF model, its first bytes are not 'GGUF'")
            needed = _bytes_at_least(file)
    except FileNotFoundError:
        raise ModelFailed(f"{path}: there is no such model file") from None
    except OSError as error:
        raise ModelFailed(f"{path}: cannot be read: {error.strerror}") from None
    except (struct.error, ValueError, OverflowError):
        raise ModelFailed(f"{path}: truncated or damaged, its header does not read") from None
    if size < needed:
        raise ModelFailed(f"{path}: truncated, {size} bytes of at least {needed}; fetch it again")
    return size


def _bytes_at_least(file: BinaryIO) -> int:
    """A lower bound of the file's size, from where its header says that the last tensor begins."""
    _version, tensors, values = _unpack(file, "<IQQ")
    for _ in range(values):
        _skip_string(file)
        _skip_value(file, _unpack(file, "<I")[0])
    last_offset, last_weights = 0, 0
    for _ in range(tensors):
        _skip_string(file)
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
    length = _unpack(file, "<Q")[0]
    if length > _LONGEST_STRING:
        raise ValueError(length)
    file.seek(length, 1)


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
