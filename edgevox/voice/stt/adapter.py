"""What is added to Whisper's weights, so that it hears through noise and rooms, and sooner.

Whisper listens to 30 s, however little was said. With this it needs no more than there is, which is
most of its time, and of what noise hides it understands more. What it learnt from, and how well it
hears, is in training/adapter/README.md; `training/adapter/train.py` made it.
"""

import functools
import hashlib
from collections.abc import Mapping
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edgevox.voice.whisper_file import FILE, Added, added_of

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
    """What the arrays of the model in this folder are to be more; nothing for all but one model.

    Raises `OSError` where its file cannot be read.
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
