"""Whisper's encoder in PyTorch, with what it learns in addition: two narrow matrices an array.

What is added to an array is the product of both, so little is learnt and little has to be kept;
`edgevox/voice/stt/adapter.py` adds it to Whisper's own when it runs (LoRA, Hu and others 2021).
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import torch
from torch import nn
from torch.nn import functional as nnf

from edgevox.voice.stop_spotter.network import CHANNELS
from edgevox.voice.stt.adapter import DOWN, UP, Added, arrays

LAYERS, HEADS = 4, 6
_NARROW = (
    "self_attention/linear_0",
    "self_attention/linear_1",
    "ffn/linear_0",
    "ffn/linear_1",
)


class Adapted(nn.Module):
    """An array of a network, as it is, and what is added to it: two matrices of this rank, which
    may be 0; those that are known, if any are.
    """

    def __init__(
        self, weights: torch.Tensor, bias: torch.Tensor, rank: int, known: Added | None = None
    ) -> None:
        super().__init__()
        self.shape = weights.shape
        self.register_buffer("weights", weights.flatten(1), persistent=False)
        self.register_buffer("bias", bias, persistent=False)
        inputs = self.weights.shape[1]
        self.down = nn.Parameter(torch.randn(rank, inputs) / math.sqrt(inputs))
        self.up = nn.Parameter(torch.zeros(len(bias), rank))
        if known:
            with torch.no_grad():  # of a lower rank: the rest begins with nothing to add
                self.down[: len(known.down)] = torch.from_numpy(known.down)
                self.up[:, : known.up.shape[1]] = torch.from_numpy(known.up)

    @property
    def all_weights(self) -> torch.Tensor:
        return (self.weights + self.up @ self.down).view(self.shape)

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        return nnf.linear(values, self.all_weights, self.bias)

    def named(self, name: str) -> Iterator[tuple[str, np.ndarray]]:
        """Both matrices, with the names of their file."""
        for end, half in ((UP, self.up), (DOWN, self.down)):
            yield f"{name}{end}", half.detach().cpu().numpy().astype(np.float64)

    def convolved(self, values: torch.Tensor, stride: int) -> torch.Tensor:
        return nnf.conv1d(values, self.all_weights, self.bias, stride, padding=1)


class Fixed(nn.Module):
    """Norms and places, which do not learn, by the names of their arrays."""

    def __init__(self, held: Mapping[str, torch.Tensor]) -> None:
        super().__init__()
        for name, one in held.items():
            if "norm" in name or "pos" in name:
                self.register_buffer(name.replace("/", ":"), one, persistent=False)

    def __getitem__(self, name: str) -> torch.Tensor:
        return self.get_buffer(name.replace("/", ":"))


class Encoder(nn.Module):
    """Bands (looks, bands, rows) to what the encoder makes of them (looks, steps, channels).

    It begins with what is `known` of what is added, by the names of its arrays, else with nothing.
    """

    def __init__(
        self, folder: Path, rank: int, known: Mapping[str, Added] = MappingProxyType({})
    ) -> None:
        super().__init__()
        held = {name: torch.from_numpy(one) for name, one in arrays(folder, "encoder/").items()}
        self.fixed = Fixed(held)
        self.names = (
            "conv1", "conv2",
            *(f"layer_{layer}/{name}" for layer in range(LAYERS) for name in _NARROW),
        )  # fmt: skip
        self.adapted = nn.ModuleList(
            Adapted(
                held[f"encoder/{name}/weight"],
                held[f"encoder/{name}/bias"],
                rank,
                known.get(f"encoder/{name}/weight"),
            )
            for name in self.names
        )

    def forward(self, bands: torch.Tensor) -> torch.Tensor:
        of = dict(zip(self.names, self.adapted, strict=True))
        values = nnf.gelu(of["conv1"].convolved(bands, stride=1))
        values = nnf.gelu(of["conv2"].convolved(values, stride=2)).transpose(1, 2)
        values = values + self.fixed["encoder/position_encodings/encodings"][: values.shape[1]]
        for layer in range(LAYERS):
            into, out, wide, narrow = (of[f"layer_{layer}/{name}"] for name in _NARROW)
            parts = into(self._normed(f"layer_{layer}/self_attention/", values)).chunk(3, 2)
            asked, known, said = (
                one.unflatten(2, (HEADS, CHANNELS // HEADS)).transpose(1, 2) for one in parts
            )
            attended = nnf.scaled_dot_product_attention(asked, known, said)
            values = values + out(attended.transpose(1, 2).flatten(2))
            hidden = nnf.gelu(wide(self._normed(f"layer_{layer}/ffn/", values)))
            values = values + narrow(hidden)
        return self._normed("", values)

    def added(self) -> Iterator[tuple[str, np.ndarray]]:
        """What is added to each array, as two matrices with the names of their file."""
        for name, one in zip(self.names, self.adapted, strict=True):
            yield from one.named(f"encoder/{name}/weight")

    def _normed(self, name: str, values: torch.Tensor) -> torch.Tensor:
        gamma, beta = (self.fixed[f"encoder/{name}layer_norm/{half}"] for half in ("gamma", "beta"))
        return nnf.layer_norm(values, (CHANNELS,), gamma, beta)
