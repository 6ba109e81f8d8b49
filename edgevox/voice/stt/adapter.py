"""What is added to Whisper's weights, so that it hears through noise and rooms, and sooner.

Whisper listens to 30 s, however little was said. With this it needs no more than there is, which is
most of its time, and of what noise hides it understands more. What it learnt from, and how well it
hears, is in docs/hearing-adapter.md; `scripts/train_hearing_adapter.py` made it.
"""

import functools
import hashlib
from collections.abc import Mapping
from importlib.resources import files
from io import BytesIO
from pathlib import Path

import numpy as np

from edgevox.voice.whisper_file import FILE, Added, added_of

ADAPTER_FILE = "adapter.npz"
MODEL = "model"
"""The name in it of the SHA-256 of the `model.bin` that it is for, in hexadecimal digits."""


def adapter_for(folder: Path) -> Mapping[str, Added]:
    """What the arrays of the model in this folder are to be more; nothing for all but one model.

    Raises `OSError` where its file cannot be read.
    """
    with (folder / FILE).open("rb") as held:
        digest = hashlib.file_digest(held, "sha256").hexdigest()
    model, added = _adapter()
    return added if digest == model else {}


@functools.cache
def _adapter() -> tuple[str, Mapping[str, Added]]:
    """The one that this package brings: the digest of its model, and what is added to that."""
    held = files(__package__).joinpath(ADAPTER_FILE).read_bytes()
    with np.load(BytesIO(held)) as data:
        return str(data[MODEL]), added_of(data)
