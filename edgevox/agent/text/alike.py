"""The texts that are most like another one, among thousands of them, within a millisecond.

`difflib` compares every pair by itself. Here it compares those only whose letters are enough alike,
which is counted for all texts at once.
"""

from collections.abc import Collection, Sequence
from difflib import SequenceMatcher
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

_KINDS = 64
"""Kinds of letters that are counted: rare ones share a kind, which only lets more texts through."""


def most_alike(
    said: str, texts: Collection[str], *, most: int = 1, least: float = 0.0
) -> list[str]:
    """The texts that are most like `said`, the most similar first, of equals the first one.

    As `difflib.get_close_matches` finds them.

    Args:
        said: The text.
        texts: What it is compared with.
        most: How many are returned at most.
        least: The least ratio of `difflib.SequenceMatcher`, 0 to 1.
    """
    several = tuple(texts)
    if not several:
        return []
    bounds = _bounds(said, several, least)
    matcher = SequenceMatcher()
    matcher.set_seq2(said)
    found: list[tuple[float, int]] = []
    for at in np.argsort(-bounds, kind="stable"):
        if bounds[at] < least or (len(found) == most and bounds[at] < -found[-1][0]):
            break
        matcher.set_seq1(several[at])
        if (ratio := matcher.ratio()) >= least:
            found = sorted([*found, (-ratio, int(at))])[:most]
    return [several[at] for _, at in found]


def _bounds(said: str, texts: tuple[str, ...], least: float) -> NDArray[np.float64]:
    """What the ratio of each text is at most: as if all letters in common were in order.

    Of texts that are too long or too short, only their length counts.
    """
    counts, lengths = _kept_letters(texts)
    both = np.maximum(lengths + len(said), 1)
    found: NDArray[np.float64] = np.minimum(lengths, len(said)) * 2.0 / both
    found[lengths + len(said) == 0] = 1.0
    rows = np.flatnonzero((found >= least) & (lengths > 0))
    common = np.minimum(counts[rows], _letters((said,))[0]).sum(axis=1, dtype=np.int64)
    found[rows] = 2.0 * common / both[rows]
    return found


def _letters(texts: Sequence[str]) -> tuple[NDArray[np.uint16], NDArray[np.int64]]:
    """How often each text has each kind of letter (texts, kinds), and its length (texts)."""
    lengths = np.array([len(text) for text in texts])
    codes = np.frombuffer("".join(texts).encode("utf-32-le", "surrogatepass"), np.uint32) % _KINDS
    rows = np.repeat(np.arange(len(texts)), lengths)
    counts = np.bincount(rows * _KINDS + codes, minlength=len(texts) * _KINDS)
    return counts.reshape(len(texts), _KINDS).astype(np.uint16), lengths


_kept_letters = lru_cache(maxsize=64)(_letters)
