"""Whether the engine of a voice is installed here; nothing is loaded to find out."""

import shutil
from functools import cache
from importlib.util import find_spec

from edgevox.core.languages import Voice
from edgevox.voice.tts.espeak import COMMAND

PACKAGES = {
    "piper": ("piper",),
    "kokoro": ("kokoro_onnx",),
    "kokoro-j": ("kokoro_onnx", "pykakasi"),
    "kokoro-z": ("kokoro_onnx", "misaki", "jieba", "pypinyin", "cn2an"),
}
"""What a backend needs; Kokoro's Japanese and Chinese voices, by their first letter, need more:
espeak-ng, which makes the phonemes of the other languages, cannot read their script."""


def installed(voice: Voice) -> bool:
    """Whether everything but the voice's model is there."""
    if voice.backend == "espeak":
        return _has("espeakng_loader") or shutil.which(COMMAND) is not None
    special = f"{voice.backend}-{voice.key[0]}"
    return all(_has(name) for name in PACKAGES.get(special, PACKAGES[voice.backend]))


@cache
def _has(package: str) -> bool:
    return find_spec(package) is not None
