"""What is learnt from is made by processes beside the one that learns."""

from collections.abc import Iterator
from typing import TypeVar

import torch
from torch.utils.data import DataLoader, Dataset

T = TypeVar("T")


def made_beside(made: Dataset[T], processes: int) -> Iterator[T]:
    """What so many processes make of it, 0 for this one alone."""
    return iter(DataLoader(made, batch_size=None, num_workers=processes))


def all_made_beside(made: Dataset[torch.Tensor], processes: int) -> torch.Tensor:
    """All of it, in its order."""
    return torch.stack(list(made_beside(made, processes)))
