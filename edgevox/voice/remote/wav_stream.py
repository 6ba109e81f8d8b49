"""A WAV file as it comes over a network: its length is not known, and its end may be missing."""

import struct

import numpy as np

from edgevox.core.servers.errors import Unusable
from edgevox.voice.audio import Samples
from edgevox.voice.wav import WIDTHS, pcm_to_mono

LEAST_HZ, MOST_HZ = 8000, 192_000
MOST_CHANNELS = 8
_PCM, _EXTENSIBLE = 1, 0xFFFE
_LONGEST_HEADER = 1 << 16
_UNKNOWN = (0, 0x7FFFFFFF, 0x7FFFF000, 0xFFFFFFFF)
"""Lengths that writers of streams give, since they do not know it yet."""


def check_form(rate_hz: int, width: int, channels: int) -> None:
    """Raise `Unusable` for a form of sound that cannot be played."""
    if not (LEAST_HZ <= rate_hz <= MOST_HZ and width in WIDTHS and 1 <= channels <= MOST_CHANNELS):
        raise Unusable(
            f"sound of {rate_hz} Hz, {8 * width} bits, {channels} channels; expected PCM of"
            f" {LEAST_HZ} to {MOST_HZ} Hz, 8 to 32 bits, 1 to {MOST_CHANNELS} channels"
        )


class PcmStream:
    """Turns bytes of any number into mono samples; what is no whole frame waits for the rest."""

    def __init__(self, rate_hz: int, width: int, channels: int) -> None:
        check_form(rate_hz, width, channels)
        self.rate_hz = rate_hz
        self._width, self._channels = width, channels
        self._rest = b""

    def push(self, data: bytes) -> Samples:
        data = self._rest + data
        frame = self._width * self._channels
        whole = len(data) // frame * frame
        self._rest = data[whole:]
        return pcm_to_mono(data[:whole], self._width, self._channels)


class WavStream:
    """Reads a WAV file piece by piece. Raises `Unusable` for what is no WAV file of PCM."""

    def __init__(self) -> None:
        self._head = b""
        self._pcm: PcmStream | None = None
        self._left: int | None = None

    @property
    def rate_hz(self) -> int:
        """The rate in hertz; 0 until it is known."""
        return self._pcm.rate_hz if self._pcm else 0

    def push(self, data: bytes) -> Samples:
        """The samples that are whole now."""
        if self._pcm is None:
            data = self._begin(data)
        if self._pcm is None:
            return np.empty(0, np.int16)
        if self._left is not None:
            data = data[: self._left]
            self._left -= len(data)
        return self._pcm.push(data)

    def _begin(self, data: bytes) -> bytes:
        """Read the header as far as it is here; what follows it."""
        self._head += data
        head = self._head
        if head[:4] != b"RIFF"[: len(head[:4])] or head[8:12] != b"WAVE"[: len(head[8:12])]:
            raise Unusable(f"not a WAV file: {head[:16]!r}")
        at, form = 12, b""
        while len(head) >= at + 8:
            name, size = head[at : at + 4], struct.unpack_from("<I", head, at + 4)[0]
            at += 8
            if name == b"data":
                self._pcm = _stream_of(form)
                self._left = None if size in _UNKNOWN else size
                self._head = b""
                return head[at:]
            if name == b"fmt ":
                form = head[at : at + size]
            at += size + size % 2
        if len(head) > _LONGEST_HEADER:
            raise Unusable("not a WAV file: a header without end")
        return b""


def _stream_of(form: bytes) -> PcmStream:
    if len(form) < 16:
        raise Unusable("a WAV file without a format")
    kind, channels, rate_hz, _, _, bits = struct.unpack_from("<HHIIHH", form)
    if kind == _EXTENSIBLE and len(form) >= 26:
        kind = struct.unpack_from("<H", form, 24)[0]
    if kind != _PCM:
        raise Unusable(f"a WAV file of format {kind}, expected PCM ({_PCM})")
    return PcmStream(rate_hz, bits // 8, channels)
