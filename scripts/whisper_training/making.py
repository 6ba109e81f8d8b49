"""What is learnt from is made by processes beside the one that learns."""

from collections.abc import Iterator
from typing import TypeVar

from torch.utils.data import DataLoader, IterableDataset

T = TypeVar("T")


def made_beside(made: IterableDataset[T], processes: int) -> Iterator[T]:
    """What so many processes make of it, 0 for this one alone."""
    return iter(DataLoader(made, batch_size=None, num_workers=processes))
