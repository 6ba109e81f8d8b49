"""The network in PyTorch, to learn; `edgevox/voice/stop_network.py` is how it runs."""

import numpy as np
import torch
from torch import nn

from edgevox.voice.stop_encoder import CHANNELS, STEPS
from edgevox.voice.stop_network import LAST_STEPS
from stop_spotter import texts

INNER, HIDDEN, MEANS, TAPS = 96, 96, 4, 3
DROPPED = 0.2


class Network(nn.Module):
    """What the encoder made (looks, steps, channels) to scores (looks, words)."""

    def __init__(self) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(CHANNELS)
        self.drop = nn.Dropout(DROPPED)
        self.reduce = nn.Conv1d(CHANNELS, INNER, 1)
        self.place = nn.Parameter(torch.zeros(INNER, STEPS))
        self.first = nn.Conv1d(INNER, INNER, TAPS, padding=1)
        self.second = nn.Conv1d(INNER, INNER, TAPS, padding=1)
        self.attend = nn.Conv1d(INNER, MEANS, 1)
        self.hidden = nn.Linear((MEANS + 1) * INNER, HIDDEN)
        self.last = nn.Linear(HIDDEN, 1 + len(texts.WORDS))

    def forward(self, encoded: torch.Tensor) -> torch.Tensor:
        normed = self.drop(self.norm(encoded)).transpose(1, 2)
        values = torch.relu(self.reduce(normed)) + self.place
        values = values + torch.relu(self.first(values))
        values = values + torch.relu(self.second(values))
        looked_at = torch.softmax(self.attend(values), 2)
        means = torch.einsum("nct,nkt->nkc", values, looked_at).flatten(1)
        whole = torch.cat([means, values[:, :, -LAST_STEPS:].mean(2)], 1)
        return self.last(self.drop(torch.relu(self.hidden(self.drop(whole)))))


def arrays_of(
    network: Network, threshold: float, precision: type = np.float16
) -> dict[str, np.ndarray]:
    """What `edgevox/voice/stop_network.py` reads."""
    found: dict[str, np.ndarray] = {
        "scale": _numbers(network.norm.weight),
        "shift": _numbers(network.norm.bias),
        "place": _numbers(network.place).T,
    }
    for name in ("reduce", "first", "second", "attend", "hidden", "last"):
        layer = getattr(network, name)
        weights = _numbers(layer.weight)
        if weights.ndim == 3:  # (out, in, taps) of a convolution
            weights = weights.transpose(0, 2, 1).reshape(len(weights), -1)
        found[name], found[f"{name}_bias"] = weights.T, _numbers(layer.bias)
    packed = {name: np.ascontiguousarray(array, precision) for name, array in found.items()}
    packed["words"] = np.array(["", *texts.WORDS])
    packed["threshold"] = np.float64(threshold)
    return packed


def _numbers(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().numpy().astype(np.float64)
