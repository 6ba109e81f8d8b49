"""Playing with PortAudio, at the rate that the device has by itself."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from edgevox.voice import devices
from edgevox.voice.audio import Samples
from edgevox.voice.devices import DeviceMissing

LATENCY_S = 0.04
_BLOCK_S = 0.01
_LONGEST_DELAY_S = 1.0

Fill = Callable[[int, float], Samples]
"""The next samples: how many, and how many seconds from now the first is heard."""


@dataclass(frozen=True, slots=True)
class Playback:
    """A running stream of PortAudio."""

    name: str
    rate_hz: int
    stream: Any

    @property
    def active(self) -> bool:
        return devices.is_active(self.stream)


@contextmanager
def open_loudspeaker(name: str, fill: Fill, opened: Callable[[int], None]) -> Iterator[Playback]:
    """Play on the device of this name, as `card.Opener` says it."""
    with devices.portaudio_errors():
        devices.look_again()
    with devices.in_use(), devices.portaudio_errors():
        import sounddevice

        device = devices.find(name, "output")
        channels = min(2, device.channels)
        opened(device.rate_hz)

        def callback(block: Any, frames: int, time: Any, _status: Any) -> None:
            delay_s = time.outputBufferDacTime - time.currentTime
            block[:] = fill(frames, min(max(delay_s, 0.0), _LONGEST_DELAY_S))[:, None]

        try:
            with sounddevice.OutputStream(
                device=device.index,
                samplerate=device.rate_hz,
                channels=channels,
                dtype="int16",
                blocksize=int(_BLOCK_S * device.rate_hz),
                latency=LATENCY_S,
                callback=callback,
            ) as stream:
                try:
                    yield Playback(device.name, device.rate_hz, stream)
                finally:
                    stream.abort()  # to stop it would wait for a device that may be gone
        except sounddevice.PortAudioError as error:
            raise DeviceMissing(f"{device.name} cannot be opened: {error}") from None
