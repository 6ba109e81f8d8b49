"""Whisper's bands of many sounds at once, in PyTorch, where the training is: processors are busy
with what is to be heard.
"""

import torch
from faster_whisper.feature_extractor import FeatureExtractor
from torch.nn.functional import pad

from edgevox.voice.audio import FULL_SCALE
from edgevox.voice.stop_spotter.network import (
    BANDS,
    HOP_SAMPLES,
    LEAST,
    LOUDEST,
    RANGE,
    WINDOW_SAMPLES,
)

_AFTER_SAMPLES = 160


class Bands:
    """Makes them on this device."""

    def __init__(self, device: str) -> None:
        self._taper = torch.hann_window(WINDOW_SAMPLES, device=device)
        filters = torch.from_numpy(FeatureExtractor(feature_size=BANDS).mel_filters)
        self._filters = filters.float().T.to(device)

    def of_looks(self, sounds: torch.Tensor) -> torch.Tensor:
        """Bands by `edgevox.voice.stop_spotter.network.bands_of`.

        From int16 (sounds, `SAMPLES`) to (sounds, bands, rows).
        """
        loudness = self._loudness(sounds.float() / FULL_SCALE)
        beside = loudness - loudness.amax((1, 2), keepdim=True)
        return (beside.clamp(min=-RANGE) + LOUDEST + 4) / 4

    def of_sounds(self, sounds: torch.Tensor, sizes: torch.Tensor, rows: int) -> torch.Tensor:
        """What faster-whisper makes of each, of which so many samples are sound: int16
        (sounds, samples) to (sounds, bands, rows), 0 where nothing is.
        """
        half = WINDOW_SAMPLES // 2
        scaled = pad(sounds.float() / FULL_SCALE, (0, _AFTER_SAMPLES + half))
        before = scaled[:, 1 : half + 1].flip(1)
        loudness = self._loudness(torch.cat([before, scaled], 1))
        heard = sizes // HOP_SAMPLES
        there = torch.arange(loudness.shape[2], device=sounds.device) < heard[:, None]
        there = there[:, None]
        loudest = loudness.masked_fill(~there, -torch.inf).amax((1, 2), keepdim=True)
        found = (torch.maximum(loudness, loudest - RANGE) + 4) / 4 * there
        return pad(found, (0, max(0, rows - found.shape[2])))[:, :, :rows]

    def _loudness(self, scaled: torch.Tensor) -> torch.Tensor:
        """In powers of ten."""
        windows = scaled.unfold(1, WINDOW_SAMPLES, HOP_SAMPLES)
        spectrum = torch.fft.rfft(windows * self._taper)
        power = spectrum.real**2 + spectrum.imag**2
        return (power @ self._filters).clamp(min=LEAST).log10().transpose(1, 2)
