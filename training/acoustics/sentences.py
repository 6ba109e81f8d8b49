"""English without stop words, kept in a file: what is said does not change when the pages do."""

import functools
import tomllib
from pathlib import Path

from training.acoustics import Half

FILE = Path(__file__).with_name("sentences.toml")


@functools.cache
def sentences(half: Half) -> tuple[str, ...]:
    """Those of this part; no sentence is in two."""
    return tuple(tomllib.loads(FILE.read_text("utf-8"))[half.name.casefold()])
