"""The network in PyTorch, to learn; `edgevox/voice/stop_network.py` is how it runs."""

import numpy as np
import torch
from torch import nn
from torch.nn import functional

from edgevox.voice.stop_features import BANDS
from edgevox.voice.stop_network import STRIDE
from stop_spotter import texts
from stop_spotter.examples import IGNORED, WITHIN

CHANNELS = 64
TAPS, BLOCK_TAPS = 6, 3
DILATIONS = (1, 1, 2, 2, 4, 4, 8)
_CLOSEST = 0.8  # how much the worst step of an example counts beside the mean


class Block(nn.Module):
    """A convolution over past time, added to what went in."""

    def __init__(self, dilation: int) -> None:
        super().__init__()
        self.reach = (BLOCK_TAPS - 1) * dilation
        self.mixing = nn.Conv1d(CHANNELS, CHANNELS, BLOCK_TAPS, dilation=dilation)
        self.norm = nn.BatchNorm1d(CHANNELS)

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        mixed = self.norm(self.mixing(functional.pad(values, (self.reach, 0))))
        return values + functional.relu(mixed)


class Network(nn.Module):
    """Features (examples, rows, bands) to scores (examples, words, steps)."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Conv1d(BANDS, CHANNELS, TAPS, stride=STRIDE)
        self.norm = nn.BatchNorm1d(CHANNELS)
        self.blocks = nn.Sequential(*[Block(dilation) for dilation in DILATIONS])
        self.drop = nn.Dropout(0.1)
        self.last = nn.Conv1d(CHANNELS, 1 + len(texts.WORDS), 1)

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        values = functional.pad(rows.transpose(1, 2), (TAPS - STRIDE, 0))
        values = functional.relu(self.norm(self.first(values)))
        return self.last(self.drop(self.blocks(values)))


def loss_of(scores: torch.Tensor, labels: torch.Tensor, word: torch.Tensor) -> torch.Tensor:
    """Of every example, cross entropy of the steps that are judged, the worst of no word more so.

    Of a word within an example, that of the step that hears it best.
    """
    logs = functional.log_softmax(scores, 1)
    judged = labels >= 0
    wanted = torch.where(judged, labels, 0)
    costs = -logs.gather(1, wanted[:, None]).squeeze(1) * judged
    none, said = judged & (labels == 0), judged & (labels > 0)
    quiet = (costs * none).sum(1) / none.sum(1).clamp(min=1) * 2
    quiet = quiet + _CLOSEST * (costs * none).max(1).values
    spoken = (costs * said).sum(1) / said.sum(1).clamp(min=1)
    inside = labels == WITHIN
    mine = logs.gather(1, word[:, None, None].expand(-1, 1, logs.shape[2])).squeeze(1)
    smooth = functional.avg_pool1d(mine[:, None], 3, 1, 1).squeeze(1)
    best = -torch.where(inside, smooth, torch.full_like(mine, -1e4)).max(1).values
    return quiet + spoken + torch.where(inside.any(1), best, torch.zeros_like(best))


def arrays_of(
    network: Network, threshold: float, precision: type = np.float16
) -> dict[str, np.ndarray]:
    """What `edgevox/voice/stop_network.py` reads, each norm folded into its convolution."""
    network.eval()
    weight, bias = _folded(network.first, network.norm)
    found: dict[str, np.ndarray] = {
        "first": weight.transpose(2, 1, 0).reshape(TAPS * BANDS, CHANNELS),
        "first_bias": bias,
        "last": _numbers(network.last.weight)[:, :, 0].T,
        "last_bias": _numbers(network.last.bias),
    }
    for number, block in enumerate(network.blocks):
        weight, bias = _folded(block.mixing, block.norm)
        flat = weight.transpose(2, 1, 0).reshape(BLOCK_TAPS * CHANNELS, CHANNELS)
        found[f"block{number}"], found[f"block_bias{number}"] = flat, bias
    packed = {name: np.ascontiguousarray(array, precision) for name, array in found.items()}
    packed["dilations"] = np.array(DILATIONS)
    packed["words"] = np.array(["", *texts.WORDS])
    packed["threshold"] = np.float64(threshold)
    return packed


def _numbers(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().numpy().astype(np.float64)


def _folded(layer: nn.Conv1d, norm: nn.BatchNorm1d) -> tuple[np.ndarray, np.ndarray]:
    scale = _numbers(norm.weight) / np.sqrt(_numbers(norm.running_var) + norm.eps)
    bias = (_numbers(layer.bias) - _numbers(norm.running_mean)) * scale + _numbers(norm.bias)
    return _numbers(layer.weight) * scale[:, None, None], bias


__all__ = ["IGNORED", "Network", "arrays_of", "loss_of"]
