"""Matrix products on the thread that asks for them.

NumPy's library spreads large ones over all cores; where these are busy, it waits for them, and what
takes 0.2 ms takes 50. What is cut into small ones it computes at once.
"""

import numpy as np
from numpy.typing import NDArray

MOST = 250_000
"""Multiplications together, about as many as OpenBLAS does not spread."""


def product(rows: NDArray[np.float32], matrix: NDArray[np.float32]) -> NDArray[np.float32]:
    """Of rows (n, k), one after the other, and a matrix (k, m): shape (n, m)."""
    found = np.empty((len(rows), matrix.shape[1]), np.float32)
    together = max(1, MOST // matrix.size)
    for first in range(0, len(rows), together):
        some = slice(first, first + together)
        np.matmul(rows[some], matrix, out=found[some])
    return found
