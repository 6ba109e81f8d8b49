"""Voice activity detection: Silero's network, a frame at a time."""

import functools
from importlib import util
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.voice.audio import FRAME_SAMPLES, FULL_SCALE, Samples

_CONTEXT = 64  # samples of the frame before, which the network sees again
_STATE = (1, 1, 128)


class VoiceDetector(Protocol):
    """Judges one frame after the other.

    `any_voice` is the probability, 0 to 1, that the last frame held a voice, near or far;
    `probability` may leave out voices that do not speak to the robot.
    """

    @property
    def any_voice(self) -> float: ...

    def probability(self, samples: Samples) -> float:
        """Return the probability that the frame holds a voice, 0 to 1."""

    def reset(self) -> None:
        """Forget the frames before: the next one does not follow on them."""

    def another(self) -> "VoiceDetector":
        """Return a fresh detector of the same kind, for other sound."""


class SileroVad:
    """Silero VAD v6 on one thread, which sleeps between frames; 0.1 ms a frame.

    `path` is the ONNX file; by default the one that comes with faster-whisper.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or bundled_vad()
        self._session = _network(self._path)
        self._input = np.zeros((1, _CONTEXT + FRAME_SAMPLES), np.float32)
        self._h = self._c = np.zeros(_STATE, np.float32)
        self.any_voice = 0.0

    def probability(self, samples: Samples) -> float:
        self._input[0, :_CONTEXT] = self._input[0, -_CONTEXT:]
        self._input[0, _CONTEXT:] = samples / np.float32(FULL_SCALE)
        found, self._h, self._c = self._session.run(
            None, {"input": self._input, "h": self._h, "c": self._c}
        )
        self.any_voice = float(found[0])
        return self.any_voice

    def reset(self) -> None:
        self._h = self._c = np.zeros(_STATE, np.float32)
        self._input[:] = 0

    def another(self) -> "SileroVad":
        return SileroVad(self._path)


@functools.cache
def _network(path: Path) -> Any:
    """Load one network for all listeners; it may be used from any thread."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])


def bundled_vad() -> Path:
    """Silero's file in faster-whisper, found without importing that."""
    spec = util.find_spec("faster_whisper")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for path in sorted(Path(folder, "assets").glob("silero_vad*.onnx")):
            return path
    raise EdgeVoxError(f"voice activity: no silero_vad.onnx; {install_extra('voice')} brings it")
