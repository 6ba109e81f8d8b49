"""The sink that the setting `audio_out` names."""

from pathlib import Path

from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import AudioSink
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.sinks.card import SoundCardSink
from edgevox.voice.sinks.paced import PacedOutput, PacedSink, Silence
from edgevox.voice.sinks.wav_file import WavFile

ROS2 = "ros2"
NONE = "none"


def open_sink(
    spec: str,
    *,
    relay: PacedOutput | None = None,
    clock: Clock | None = None,
    played: PlayedSound | None = None,
) -> AudioSink:
    """The sink for `audio_out`.

    Empty is the default loudspeaker, ``none`` silence, ``ros2`` the relay that
    `edgevox.ros2.audio` connects to, a path a WAV file, anything else a loudspeaker's name. A
    path ends in ``.wav`` or has a slash. What can be heard of it in a room is told to `played`.
    Raises `InvalidValue`.
    """
    if spec == NONE:
        return PacedSink(Silence(), clock=clock)
    if spec == ROS2:
        if relay is None:
            raise InvalidValue("audio_out", spec, "ros2 only together with --ros2")
        return PacedSink(relay, clock=clock, played=played)
    path = Path(spec).expanduser()
    if spec and ("/" in spec or path.suffix.lower() == ".wav"):
        return _file(path, clock)
    return SoundCardSink(spec, clock=clock, played=played)


def _file(path: Path, clock: Clock | None) -> AudioSink:
    if path.is_dir() or path.suffix.lower() != ".wav":
        raise InvalidValue("audio_out", str(path), "a file whose name ends in .wav")
    return PacedSink(WavFile(path, clock), clock=clock)
