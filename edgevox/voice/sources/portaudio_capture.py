"""Capturing with PortAudio, at the rate that the device can do."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from edgevox.voice import devices
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.devices import DeviceMissing
from edgevox.voice.resample import Resampler


@dataclass(frozen=True, slots=True)
class Capture:
    """A running stream of PortAudio."""

    name: str
    stream: Any

    @property
    def active(self) -> bool:
        return devices.is_active(self.stream)


@contextmanager
def open_microphone(name: str, hear: Callable[[Samples], None]) -> Iterator[Capture]:
    """Capture from the device of this name, as `soundcard.Opener` says it."""
    with devices.portaudio_errors():
        devices.look_again()
    with devices.in_use(), devices.portaudio_errors():
        import sounddevice

        device = devices.find(name, "input")
        rate_hz, channels = _format(sounddevice, device)
        resampler = Resampler(rate_hz, RATE_HZ)

        def callback(block: Any, _frames: int, _time: Any, _status: Any) -> None:
            hear(resampler.push(block[:, 0].copy()))

        try:
            with sounddevice.InputStream(
                device=device.index,
                samplerate=rate_hz,
                channels=channels,
                dtype="int16",
                blocksize=FRAME_SAMPLES * rate_hz // RATE_HZ,
                callback=callback,
            ) as stream:
                try:
                    yield Capture(device.name, stream)
                finally:
                    stream.abort()  # to stop it would wait for a device that may be gone
        except sounddevice.PortAudioError as error:
            raise DeviceMissing(f"{device.name} cannot be opened: {error}") from None


def _format(sounddevice: Any, device: devices.Device) -> tuple[int, int]:
    """Rate in hertz and channels: 16 kHz mono, or else what the device does by itself.

    Of several channels the first is heard: on arrays of microphones it is the processed one.
    """
    try:
        sounddevice.check_input_settings(device.index, 1, "int16", samplerate=RATE_HZ)
    except (sounddevice.PortAudioError, ValueError):
        return device.rate_hz, device.channels
    return RATE_HZ, 1
