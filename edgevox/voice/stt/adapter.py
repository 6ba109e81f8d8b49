"""The adapter to Whisper's weights: better in noise and rooms, and faster.

Whisper listens to 30 s, however short the speech is. With the adapter it needs only the speech,
which saves most of its time, and it understands more in rooms and noise. Real people close to their
microphone it hears worse, but better with a quarter of the adapter: so the one hears where the
other is not sure (`whisper.py`). Its training data and results are in training/adapter/README.md;
`training/adapter/train.py` made it.

This module also writes CTranslate2's model file, `model.bin`, with the adapter added. The file is a
header, then each array with its name, shape, type and bytes, then further names for the same
arrays; all numbers are little-endian (`ctranslate2.specs.ModelSpec` writes it).
"""

import functools
import hashlib
import math
import os
import struct
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import EdgeVoxError

FILE = "model.bin"
UP, DOWN = ".up", ".down"
"""Suffixes, after an array's name, of the two matrices whose product is added to it."""
_FORMAT = 6
_FLOATS: Mapping[int, str] = {0: "<f4", 4: "<f2"}
"""The types of arrays that something can be added to, by CTranslate2's number."""


class NotAWhisperFile(EdgeVoxError):
    """The file cannot be read here, or lacks an array; the message names the fault."""


class Added(NamedTuple):
    """An addition to one array: the product of two narrow matrices (LoRA)."""

    up: NDArray[np.float32]
    down: NDArray[np.float32]

    @property
    def size(self) -> int:
        return len(self.up) * int(self.down.shape[1])

    @property
    def numbers(self) -> NDArray[np.float32]:
        return (self.up @ self.down).ravel()


def weakened(added: Mapping[str, Added], share: float) -> dict[str, Added]:
    """Return this share of the additions, 0 to 1."""
    return {name: one._replace(up=one.up * np.float32(share)) for name, one in added.items()}


def added_of(data: Mapping[str, Any]) -> dict[str, Added]:
    """Read the additions from a file's arrays, by the names of the arrays that they change.

    Raises `KeyError` if one of the two matrices is missing.
    """
    names = (name.removesuffix(UP) for name in data if name.endswith(UP))
    return {
        name: Added(
            np.asarray(data[name + UP], np.float32), np.asarray(data[name + DOWN], np.float32)
        )
        for name in names
    }


@dataclass(frozen=True, slots=True)
class _Array:
    name: str
    shape: tuple[int, ...]
    type: int
    begin: int


@contextmanager
def adapted_folder(folder: Path, added: Mapping[str, Added]) -> Iterator[Path]:
    """Yield a folder with the model's files and the additions in its arrays.

    CTranslate2 keeps the bytes of a model that it is given, 75 MB of the smallest one, beside its
    own copy; of a file it keeps nothing. This file is in memory alone, and is removed at the end.
    Raises the errors of `adapted`.
    """
    held = adapted(folder, added)
    with ExitStack() as stack:
        file = stack.enter_context(os.fdopen(os.memfd_create(FILE), "wb"))
        file.write(held)
        file.flush()
        del held
        place = Path(stack.enter_context(TemporaryDirectory(prefix="edgevox-model-")))
        (place / FILE).symlink_to(f"/proc/self/fd/{file.fileno()}")
        for beside in folder.iterdir():
            if beside.name != FILE and beside.is_file():
                (place / beside.name).symlink_to(beside.resolve())
        yield place


def adapted(folder: Path, added: Mapping[str, Added]) -> bytes:
    """Return the model's file with the additions in its arrays.

    `added` maps an array's name to its addition: as many numbers as the array has, in their order.
    Raises `NotAWhisperFile`, and `OSError` if a file cannot be read.
    """
    held = (folder / FILE).read_bytes()
    there = {one.name: one for one in _read(held)}
    if missing := added.keys() - there.keys():
        raise NotAWhisperFile(f"{FILE}: it has no {', '.join(sorted(missing))}")
    parts: list[bytes | memoryview] = []
    at, whole = 0, memoryview(held)  # some ten times as large as what is added to
    for one in sorted((there[name] for name in added), key=lambda one: one.begin):
        more = added[one.name]
        if one.type not in _FLOATS or math.prod(one.shape) != more.size:
            raise NotAWhisperFile(f"{FILE}: {one.name} is not {more.size} numbers of 16 or 32 bit")
        numbers = _numbers(held, one)
        changed = (numbers.astype(np.float32) + more.numbers).astype(numbers.dtype)
        parts += [whole[at : one.begin], changed.tobytes()]
        at = one.begin + numbers.nbytes
    return b"".join([*parts, whole[at:]])


def arrays(folder: Path, beginning: str) -> dict[str, NDArray[np.float32]]:
    """The arrays of numbers whose names begin so. Raises `NotAWhisperFile` and `OSError`."""
    held = (folder / FILE).read_bytes()
    return {
        one.name: _numbers(held, one).astype(np.float32).reshape(one.shape)
        for one in _read(held)
        if one.name.startswith(beginning) and one.type in _FLOATS
    }


def _numbers(held: bytes, one: _Array) -> NDArray[Any]:
    return np.frombuffer(held, _FLOATS[one.type], math.prod(one.shape), one.begin)


def _read(held: bytes) -> list[_Array]:
    try:
        return list(_walk(held))
    except (struct.error, UnicodeDecodeError) as error:
        raise NotAWhisperFile(f"{FILE}: it is no file of CTranslate2: {error}") from error


def _walk(held: bytes) -> Iterator[_Array]:
    at = 0

    def number(code: str) -> int:
        nonlocal at
        (value,) = struct.unpack_from(f"<{code}", held, at)
        at += struct.calcsize(code)
        return int(value)

    def text() -> str:
        nonlocal at
        size = number("H")
        at += size
        return held[at - size : at].rstrip(b"\0").decode()

    if (version := number("I")) != _FORMAT:
        raise NotAWhisperFile(f"{FILE}: its format is {version}, expected {_FORMAT}")
    text()
    number("I")
    for _ in range(number("I")):
        name = text()
        shape = tuple(number("I") for _ in range(number("B")))
        kind, size = number("B"), number("I")
        at += size
        if at > len(held):
            raise NotAWhisperFile(f"{FILE}: it ends within {name}")
        if kind in _FLOATS and size != math.prod(shape) * np.dtype(_FLOATS[kind]).itemsize:
            raise NotAWhisperFile(f"{FILE}: {name} has {size} bytes, not those of {shape} numbers")
        yield _Array(name, shape, kind, at - size)


ADAPTER_FILE = "adapter.npz"
MODEL, SIZE = "model", "bytes"
"""The names in it of what tells the `model.bin` that it is for: its SHA-256, in hexadecimal digits,
and how many bytes it has.
"""


class _Adapter(NamedTuple):
    model: str
    size: int
    added: Mapping[str, Added]


def adapter_for(folder: Path) -> Mapping[str, Added]:
    """Return the additions for the model in this folder; empty for all but one model.

    Raises `OSError` if the model's file cannot be read.
    """
    known, file = _adapter(), folder / FILE
    if file.stat().st_size != known.size:
        return {}
    with file.open("rb") as held:
        digest = hashlib.file_digest(held, "sha256").hexdigest()
    return known.added if digest == known.model else {}


@functools.cache
def _adapter() -> _Adapter:
    """The one that this package brings."""
    held = files(__package__).joinpath(ADAPTER_FILE).read_bytes()
    with np.load(BytesIO(held)) as data:
        return _Adapter(str(data[MODEL]), int(data[SIZE]), added_of(data))
