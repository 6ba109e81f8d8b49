"""The source that a setting names, and a source without a microphone."""

import threading
from pathlib import Path

from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import AudioSource, Frame
from edgevox.voice.sources.files import WavFiles, wav_files
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.sources.soundcard import SoundCard
from edgevox.voice.wav import check_wav


class Nothing:
    """Never hears anything; reading only waits."""

    name = "none"

    def __init__(self) -> None:
        self._closed = threading.Event()

    def start(self) -> None: ...

    def read(self, timeout_s: float) -> Frame | None:
        self._closed.wait(timeout_s)
        return None

    def close(self) -> None:
        self._closed.set()


ROS2 = "ros2"
NONE = "none"


def open_source(spec: str, *, paced: bool = True, clock: Clock | None = None) -> AudioSource:
    """The source that `audio_in` names; it captures nothing before its `start`.

    Empty is the default microphone, ``ros2`` a `Pushed` that `edgevox.ros2.audio` fills,
    ``none`` no microphone, a path a WAV file or a folder of them, anything else a microphone's
    name. A path is what exists, ends in ``.wav`` or has a slash. Raises `InvalidValue`.
    """
    if spec == NONE:
        return Nothing()
    if spec == ROS2:
        return Pushed("audio_in", clock)
    place = Path(spec).expanduser()
    if spec and ("/" in spec or place.suffix.lower() == ".wav" or place.exists()):
        return _files(place, paced, clock)
    return SoundCard(spec, clock=clock)


def _files(place: Path, paced: bool, clock: Clock | None) -> WavFiles:
    if not place.exists():
        raise InvalidValue("audio_in", str(place), "a WAV file or a folder of them that exists")
    paths = wav_files(place)
    if not paths:
        raise InvalidValue("audio_in", str(place), "a folder with WAV files in it")
    for path in paths:
        check_wav(path)
    return WavFiles(paths, paced=paced, clock=clock)
