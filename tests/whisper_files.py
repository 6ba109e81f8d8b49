"""Files of Whisper's weights as CTranslate2 writes them, small."""

import struct

import numpy as np

HALF, SINGLE, BYTES = 4, 0, 1
WEIGHTS = np.arange(6, dtype=np.float16).reshape(2, 3)


def text(value: str) -> bytes:
    return struct.pack("<H", len(value) + 1) + value.encode() + b"\0"


def array(name: str, kind: int, values: np.ndarray) -> bytes:
    shape = struct.pack(f"<B{values.ndim}I", values.ndim, *values.shape)
    return text(name) + shape + struct.pack("<BI", kind, values.nbytes) + values.tobytes()


def file_of(*held: bytes, version: int = 6) -> bytes:
    """As CTranslate2 writes it: a head, arrays, and no second names."""
    head = struct.pack("<I", version) + text("WhisperSpec") + struct.pack("<II", 3, len(held))
    return head + b"".join(held) + struct.pack("<I", 0)
