"""Whisper in PyTorch, with what it learns in addition: the encoder, and where the decoder listens.

What the decoder knows of language stays as it is.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import torch
from torch import nn
from torch.nn import functional as nnf

from edgevox.voice.stop_spotter.network import CHANNELS
from edgevox.voice.stt.adapter import Added, arrays
from training.whisper.encoder import HEADS, LAYERS, Adapted, Encoder, Fixed

_LISTENING = tuple(f"attention/linear_{number}" for number in range(3))
_REST = ("self_attention/linear_0", "self_attention/linear_1", "ffn/linear_0", "ffn/linear_1")


class Decoder(nn.Module):
    """What was heard (sounds, steps, channels) and tokens (sounds, tokens) to scores."""

    def __init__(self, folder: Path, rank: int, known: Mapping[str, Added]) -> None:
        super().__init__()
        held = {name: torch.from_numpy(one) for name, one in arrays(folder, "decoder/").items()}
        self.fixed = Fixed(held)
        self.register_buffer("tokens", held["decoder/embeddings/weight"], persistent=False)
        self.names = tuple(
            f"layer_{layer}/{name}" for layer in range(LAYERS) for name in (*_LISTENING, *_REST)
        )
        self.adapted = nn.ModuleList(
            Adapted(
                held[f"decoder/{name}/weight"],
                held[f"decoder/{name}/bias"],
                rank if name.partition("/")[2] in _LISTENING else 0,
                known.get(f"decoder/{name}/weight"),
            )
            for name in self.names
        )

    def forward(
        self, heard: torch.Tensor, tokens: torch.Tensor, wanted: torch.Tensor
    ) -> torch.Tensor:
        """Scores (wanted, words) of what follows each token that is `wanted` (sounds, tokens)."""
        of = dict(zip(self.names, self.adapted, strict=True))
        places = self.fixed["decoder/position_encodings/encodings"][: tokens.shape[1]]
        values = self.tokens[tokens] + places
        for layer in range(LAYERS):
            part = f"layer_{layer}/"
            parts = of[f"{part}self_attention/linear_0"](
                self._normed(f"{part}self_attention/", values)
            ).chunk(3, 2)
            values = values + of[f"{part}self_attention/linear_1"](_attended(*parts, causal=True))
            asked = of[f"{part}attention/linear_0"](self._normed(f"{part}attention/", values))
            known, said = of[f"{part}attention/linear_1"](heard).chunk(2, 2)
            values = values + of[f"{part}attention/linear_2"](_attended(asked, known, said))
            hidden = nnf.gelu(of[f"{part}ffn/linear_0"](self._normed(f"{part}ffn/", values)))
            values = values + of[f"{part}ffn/linear_1"](hidden)
        return nnf.linear(self._normed("", values)[wanted], self.tokens).float()

    def added(self) -> Iterator[tuple[str, np.ndarray]]:
        """What is added to each array that learns, as two matrices with the names of their file."""
        for name, one in zip(self.names, self.adapted, strict=True):
            if name.partition("/")[2] in _LISTENING:
                yield from one.named(f"decoder/{name}/weight")

    def _normed(self, name: str, values: torch.Tensor) -> torch.Tensor:
        gamma, beta = (self.fixed[f"decoder/{name}layer_norm/{half}"] for half in ("gamma", "beta"))
        return nnf.layer_norm(values.float(), (CHANNELS,), gamma, beta)


class Hearing(nn.Module):
    """Bands (sounds, bands, rows) and tokens to scores. It begins with what is `known` of what is
    added, by the names of its arrays, else with nothing.
    """

    def __init__(
        self,
        folder: Path,
        of_encoder: int,
        of_decoder: int,
        known: Mapping[str, Added] = MappingProxyType({}),
    ) -> None:
        super().__init__()
        self.encoder = Encoder(folder, of_encoder, known)
        self.decoder = Decoder(folder, of_decoder, known)

    def forward(
        self, bands: torch.Tensor, tokens: torch.Tensor, wanted: torch.Tensor
    ) -> torch.Tensor:
        return self.decoder(self.encoder(bands), tokens, wanted)

    def added(self) -> dict[str, np.ndarray]:
        """What the adapter's file has of both."""
        both = (*self.encoder.added(), *self.decoder.added())
        return {name: one.astype(np.float16) for name, one in both}


def _attended(
    asked: torch.Tensor, known: torch.Tensor, said: torch.Tensor, causal: bool = False
) -> torch.Tensor:
    heads = (
        one.unflatten(2, (HEADS, CHANNELS // HEADS)).transpose(1, 2) for one in (asked, known, said)
    )
    return nnf.scaled_dot_product_attention(*heads, is_causal=causal).transpose(1, 2).flatten(2)
