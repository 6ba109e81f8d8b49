"""What is learnt from is made by processes beside the one that learns."""

from collections.abc import Callable, Iterator
from typing import TypeVar

import torch
from torch.utils.data import DataLoader, Dataset

T = TypeVar("T")


def made_beside(made: Dataset[T], processes: int) -> Iterator[T]:
    """What so many processes make of it, 0 for this one alone."""
    return iter(DataLoader(made, batch_size=None, num_workers=processes))


def all_made_beside(make: Callable[[int], torch.Tensor], many: int, processes: int) -> torch.Tensor:
    """So many tensors, of 0 and up, in this order."""
    return torch.stack(list(made_beside(_Numbered(make, many), processes)))


class _Numbered(Dataset[torch.Tensor]):
    def __init__(self, make: Callable[[int], torch.Tensor], many: int) -> None:
        self._make, self._many = make, many

    def __len__(self) -> int:
        return self._many

    def __getitem__(self, number: int) -> torch.Tensor:
        return self._make(number)
