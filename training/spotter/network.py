"""The network in PyTorch, to learn; `edgevox/voice/stop_spotter/network.py` is how it runs."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import nn

from edgevox.voice.stop_spotter.network import CHANNELS, LAST_STEPS, STEPS, StopLayer, StopWeights

INNER, INNER_OF_LANGUAGES, HIDDEN, MEANS, TAPS = 96, 128, 96, 4, 3
"""The network of the other languages is wider: it knows seven times as many words."""
DROPPED = 0.2
_LAYERS = ("reduce", "first", "second", "attend", "hidden", "last")


class Network(nn.Module):
    """What the encoder made (looks, steps, channels) to scores (looks, outputs)."""

    def __init__(self, inner: int, outputs: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(CHANNELS)
        self.drop = nn.Dropout(DROPPED)
        self.reduce = nn.Conv1d(CHANNELS, inner, 1)
        self.place = nn.Parameter(torch.zeros(inner, STEPS))
        self.first = nn.Conv1d(inner, inner, TAPS, padding=1)
        self.second = nn.Conv1d(inner, inner, TAPS, padding=1)
        self.attend = nn.Conv1d(inner, MEANS, 1)
        self.hidden = nn.Linear((MEANS + 1) * inner, HIDDEN)
        self.last = nn.Linear(HIDDEN, outputs)

    def forward(self, encoded: torch.Tensor) -> torch.Tensor:
        normed = self.drop(self.norm(encoded)).transpose(1, 2)
        values = torch.relu(self.reduce(normed)) + self.place
        values = values + torch.relu(self.first(values))
        values = values + torch.relu(self.second(values))
        looked_at = torch.softmax(self.attend(values), 2)
        means = torch.einsum("nct,nkt->nkc", values, looked_at).flatten(1)
        whole = torch.cat([means, values[:, :, -LAST_STEPS:].mean(2)], 1)
        return self.last(self.drop(torch.relu(self.hidden(self.drop(whole)))))


def layers_of(network: Network) -> dict[str, np.ndarray]:
    """Its numbers, by the names that `edgevox/voice/stop_spotter/network.py` knows them by."""
    found: dict[str, np.ndarray] = {
        "scale": _numbers(network.norm.weight),
        "shift": _numbers(network.norm.bias),
        "place": _numbers(network.place).T,
    }
    for name in _LAYERS:
        layer = getattr(network, name)
        weights = _numbers(layer.weight)
        if weights.ndim == 3:  # (out, in, taps) of a convolution
            weights = weights.transpose(0, 2, 1).reshape(len(weights), -1)
        found[name], found[f"{name}_bias"] = weights.T, _numbers(layer.bias)
    return {name: np.ascontiguousarray(array, np.float16) for name, array in found.items()}


def load(network: Network, known: Sequence[StopWeights]) -> None:
    """Let it go on from weights that run, which differ in their outputs alone."""
    first = known[0]
    last = [one.layers["last"] for one in known]
    layers = dict(first.layers)
    layers["last"] = StopLayer(
        np.concatenate([one.weights for one in last], 1), np.concatenate([one.bias for one in last])
    )
    with torch.no_grad():
        network.norm.weight.copy_(torch.from_numpy(first.scale))
        network.norm.bias.copy_(torch.from_numpy(first.shift))
        network.place.copy_(torch.from_numpy(first.place.T.copy()))
        for name in _LAYERS:
            layer, held = getattr(network, name), layers[name]
            weights = torch.from_numpy(held.weights.T.copy())
            if layer.weight.ndim == 3:  # (out, in, taps) of a convolution
                weights = weights.unflatten(1, (-1, layer.weight.shape[1])).transpose(1, 2)
            layer.weight.copy_(weights)
            layer.bias.copy_(torch.from_numpy(held.bias))


def _numbers(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().cpu().numpy().astype(np.float64)
