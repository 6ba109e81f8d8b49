"""The machine's sound devices, by name.

PortAudio, below sounddevice, is one for the whole process and lists the devices only when it
starts. Therefore code that opens a stream marks it with `in_use`, and `look_again` restarts
PortAudio only while no stream is in use: a restart would cut the loudspeaker off to find a
microphone.
"""

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Literal

from edgevox.core.errors import EdgeVoxError, install_extra

Kind = Literal["input", "output"]

RETRY_S = 3.0
"""Seconds before a missing device is tried again."""

_WORDS: Mapping[Kind, str] = {"input": "microphone", "output": "loudspeaker"}


class DeviceMissing(EdgeVoxError):
    """The sound device is not there now; it may be plugged in later."""


@dataclass(frozen=True, slots=True)
class Device:
    """A sound device: PortAudio's number for it, and its own properties."""

    index: int
    name: str
    channels: int
    rate_hz: int


class _Uses:
    """A count of the streams that this process has open."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.count = 0


_uses = _Uses()
_importing = threading.Lock()


@contextmanager
def in_use() -> Iterator[None]:
    """Wrap the life of a stream, from before it is opened until it is closed."""
    with _uses.lock:
        _uses.count += 1
    try:
        yield
    finally:
        with _uses.lock:
            _uses.count -= 1


@contextmanager
def portaudio_errors() -> Iterator[None]:
    """Turn PortAudio's errors into `DeviceMissing`.

    So a failing device is tried again, like a missing one.
    """
    sounddevice = _sounddevice()
    try:
        yield
    except (sounddevice.PortAudioError, ValueError, OSError) as error:
        raise DeviceMissing(f"PortAudio fails: {error}") from None


def is_active(stream: Any) -> bool:
    """Return whether PortAudio still serves this stream.

    A device that is gone may fail to say so.
    """
    try:
        with portaudio_errors():
            return bool(stream.active)
    except DeviceMissing:
        return False


def look_again() -> None:
    """Look for devices that were plugged in or out, unless a stream is in use."""
    sounddevice = _sounddevice()
    with _uses.lock:
        if not _uses.count:
            sounddevice._terminate()  # noqa: SLF001 - there is no other way
            sounddevice._initialize()  # noqa: SLF001


def devices(kind: Kind) -> list[Device]:
    """All that are there. Raises `DeviceMissing` where sound cannot be used at all."""
    listed: Sequence[Mapping[str, Any]] = _sounddevice().query_devices()
    return [_device(entry, kind) for entry in listed if entry[f"max_{kind}_channels"] > 0]


def find(name: str, kind: Kind) -> Device:
    """Return the device whose name this is, or contains this; the default one for an empty name.

    Raises `DeviceMissing`, which names the present ones.
    """
    found = devices(kind)
    if not name:
        return _default(kind, found)
    return choose(name, kind, found)


def choose(name: str, kind: Kind, found: Sequence[Device]) -> Device:
    """The device with this name, else the first that has it in its name, in any case."""
    wanted = name.casefold()
    for device in (
        *(d for d in found if d.name.casefold() == wanted),
        *(d for d in found if wanted in d.name.casefold()),
    ):
        return device
    here = ", ".join(repr(device.name) for device in found) or "none at all"
    raise DeviceMissing(f"no {_WORDS[kind]} {name!r} on this machine; it has {here}")


def _default(kind: Kind, found: Sequence[Device]) -> Device:
    default = _sounddevice().default.device[kind]
    for device in (*(d for d in found if d.index == default), *found):
        return device
    raise DeviceMissing(f"no {_WORDS[kind]} on this machine")


def _device(entry: Mapping[str, Any], kind: Kind) -> Device:
    return Device(
        index=entry["index"],
        name=entry["name"],
        channels=entry[f"max_{kind}_channels"],
        rate_hz=int(entry["default_samplerate"]),
    )


def _sounddevice() -> Any:
    """Imported late: without PortAudio its import fails, and a robot without sound needs none.

    One thread at a time: a thread that waits for an import that fails gets an unfinished module.
    """
    try:
        with _importing:
            import sounddevice
    except ImportError:
        raise DeviceMissing(f"sound needs an extra: {install_extra('voice')}") from None
    except OSError:
        raise DeviceMissing("sound needs PortAudio: sudo apt install libportaudio2") from None
    return sounddevice
