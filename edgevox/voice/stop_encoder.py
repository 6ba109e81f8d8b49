"""What the stop word spotter looks at: the last 1.1 s of sound, as Whisper's encoder hears them.

Whisper's smallest English network was trained on the speech of very many people in all kinds of
places; what its encoder makes of a sound tells words apart in noise far better than anything that
can be learnt from the voices here. It takes 3 to 4 ms for so short a sound, which it was not made
for: what it says of it is learnt anew by `stop_network`.
"""

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import Samples
from edgevox.voice.level import FULL_SCALE
from edgevox.voice.one_thread import product
from edgevox.voice.whisper_file import Added, adapted_folder

Floats = NDArray[np.float32]

ENCODER = "whisper-tiny.en"
"""The model whose encoder it is, as the manifest names it."""
BANDS, WINDOW_SAMPLES, HOP_SAMPLES = 80, 400, 160
"""Whisper's own: 25 ms of sound every 10 ms."""
_ROWS = 112
SAMPLES = WINDOW_SAMPLES + (_ROWS - 1) * HOP_SAMPLES
"""How much sound it looks at, 1.135 s at 16 kHz."""
STEPS, CHANNELS = _ROWS // 2, 384
"""What comes of that: a step in 20 ms."""
RANGE = 8.0  # what is softer than the loudest by more than so many powers of ten is not heard
LOUDEST = 0.5  # how loud the loudest always is, in powers of ten
LEAST = 1e-10  # what is softer is as soft as this
_TAPER = np.hanning(WINDOW_SAMPLES + 1)[:-1].astype(np.float32)


def bands_of(sound: Samples) -> Floats:
    """How loud Whisper's bands are in `SAMPLES` samples, shape (`BANDS`, rows).

    The loudest is always the same, so how loud one speaks does not matter.
    """
    scaled = sound.astype(np.float32) / FULL_SCALE
    windows = np.lib.stride_tricks.sliding_window_view(scaled, WINDOW_SAMPLES)[::HOP_SAMPLES]
    spectrum = np.fft.rfft(windows * _TAPER)
    power = (spectrum.real**2 + spectrum.imag**2).astype(np.float32)
    loudness = np.log10(np.maximum(product(power, _bands()), LEAST)).T
    beside = np.maximum(loudness - loudness.max(), -RANGE)
    return np.asarray((beside + LOUDEST + 4) / 4, np.float32)


@functools.cache
def _bands() -> Floats:
    """What each frequency is to each band, shape (frequencies, `BANDS`)."""
    from faster_whisper.feature_extractor import FeatureExtractor

    return np.ascontiguousarray(FeatureExtractor(feature_size=BANDS).mel_filters.T, np.float32)


class EncoderNotLoaded(EdgeVoxError):
    """Loading it failed; the message says why."""


class StopEncoder:
    """Whisper's encoder, from its folder, loaded when it is first asked.

    Where that fails it is not tried again: who looks every 64 ms would do nothing else.

    `added` is what its arrays are to be more than Whisper's, by their names. It computes on one
    core, beside the one that transcribes: who waited for that would be late.
    """

    def __init__(self, folder: Path, added: Mapping[str, Added]) -> None:
        self._folder = folder
        self._added = added

    def of(self, sounds: Sequence[Samples]) -> Floats:
        """Of `SAMPLES` samples each, shape (sounds, `STEPS`, `CHANNELS`).

        Raises `EncoderNotLoaded`.
        """
        import ctranslate2

        if isinstance(self._loaded, str):
            raise EncoderNotLoaded(self._loaded)

        bands = np.ascontiguousarray(np.stack([bands_of(sound) for sound in sounds]))
        encoded = self._loaded.encode(ctranslate2.StorageView.from_array(bands))
        return np.asarray(encoded, np.float32)

    @functools.cached_property
    def _loaded(self) -> Any:
        """The model, or in words why there is none."""
        import ctranslate2

        try:
            with adapted_folder(self._folder, self._added) as folder:
                return ctranslate2.models.Whisper(
                    str(folder), device="cpu", compute_type="int8",
                    inter_threads=1, intra_threads=1,
                )  # fmt: skip
        except Exception as error:  # noqa: BLE001 - whatever the library raises
            return f"{type(error).__name__}: {error}"
