"""Files of language models that have a header and no weights."""

import struct
from pathlib import Path


def with_numbers(**numbers: int) -> bytes:
    """The header of a file without weights."""
    values = [
        struct.pack("<Q", len(f"qwen2.{name}"))
        + f"qwen2.{name}".encode()
        + struct.pack("<II", 4, n)
        for name, n in numbers.items()
    ]
    return b"GGUF" + struct.pack("<IQQ", 3, 0, len(values)) + b"".join(values)


def small_gguf(folder: Path) -> Path:
    """What says of itself how much memory its context takes."""
    numbers = {"block_count": 24, "embedding_length": 896}
    numbers |= {"attention.head_count": 14, "attention.head_count_kv": 2}
    path = folder / "small.gguf"
    path.write_bytes(with_numbers(**numbers))
    return path
