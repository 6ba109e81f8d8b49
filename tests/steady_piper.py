"""Piper without its randomness, so that each run hears the same: it draws how it speaks."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from piper import PiperVoice, SynthesisConfig

STEADY = SynthesisConfig(noise_scale=0.0, noise_w_scale=0.0)


@contextmanager
def steady_piper() -> Iterator[None]:
    """Has whoever synthesises in this process, and says nothing of it, do so."""
    synthesize = PiperVoice.synthesize
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            PiperVoice, "synthesize", lambda one, text, how=STEADY: synthesize(one, text, how)
        )
        yield
