"""A sink that plays against the clock: speech takes the time that it would take in a room.

`PacedOutput` takes its sound; `Silence` keeps none. Also here, for every sink: waiting against a
clock, changing the rate, and the loudness over time.

`Relay` hands speech to another player, such as a speaker node of ROS 2. `TappedSink` lets other
listeners hear what plays on the chosen sink.
"""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.status import fault_of
from edgevox.voice.audio import RATE_HZ, AudioSink, Chunk, Samples, rms
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.wav import Resampler


class PacedOutput(Protocol):
    """Takes sound when it is due. Used under the sink's lock."""

    name: str
    rate_hz: int
    block_s: float
    """Seconds of sound in each write."""
    lead_s: float
    """Seconds by which each write comes before its sound is due."""

    def write(self, samples: Samples, start_s: float) -> None:
        """Play samples at `rate_hz`, audible from the clock's time `start_s` on."""

    def close(self) -> None: ...


class Silence:
    """Nowhere: speech takes its time, and nothing is heard."""

    name = "none"
    rate_hz = 16_000
    block_s = 0.1
    lead_s = 0.0

    def write(self, samples: Samples, start_s: float) -> None: ...

    def close(self) -> None: ...


AHEAD_S = 0.1
"""Seconds of sound that a sink takes before it blocks."""

NOTHING_S = 1e-6
"""Less than this is not worth waiting for, and might not move a clock at all."""

Wait = Callable[[CancelToken, float], bool]
"""Sleeps for some seconds or until cancelled; returns True if cancelled."""


def real_wait(token: CancelToken, seconds: float) -> bool:
    """Sleep in real time."""
    return token.wait(seconds)


class RateChanger:
    """Chunks at any rate, one after another, as sound at one rate."""

    def __init__(self, rate_hz: int) -> None:
        self._to_hz = rate_hz
        self._from_hz = rate_hz
        self._engine: Resampler | None = None

    def push(self, chunk: Chunk) -> Samples:
        """Return the samples that are ready; the rest comes with the next chunk or with `flush`."""
        before = np.empty(0, np.int16)
        if self._engine is None or chunk.rate_hz != self._from_hz:
            before = self.flush()
            self._from_hz = chunk.rate_hz
            self._engine = Resampler(chunk.rate_hz, self._to_hz)
        return np.concatenate([before, self._engine.push(chunk.samples)])

    def flush(self) -> Samples:
        """Return the samples that were still inside; the next chunk starts afresh."""
        engine, self._engine = self._engine, None
        return engine.flush() if engine else np.empty(0, np.int16)


class Loudness:
    """The loudness of a sink over time, from the sound that it was given."""

    def __init__(self) -> None:
        self._blocks: deque[tuple[float, float]] = deque(maxlen=1024)

    def add(self, end_s: float, samples: Samples) -> None:
        """Add sound that is heard until `end_s`, right after the sound before."""
        self._blocks.append((end_s, rms(samples)))

    def at(self, now_s: float) -> float:
        """Root mean square, 0 to 1."""
        while self._blocks and self._blocks[0][0] <= now_s:
            self._blocks.popleft()
        return self._blocks[0][1] if self._blocks else 0.0

    def clear(self) -> None:
        """Forget all sound: nothing more is heard."""
        self._blocks.clear()


class PacedSink:
    """Gives an output its sound when it is due; a stop drops the sound that is not due yet.

    Sound that the output got early (`PacedOutput.lead_s`) may still play after a stop. `played` is
    told what was played.
    """

    def __init__(
        self,
        output: PacedOutput,
        *,
        clock: Clock | None = None,
        wait: Wait = real_wait,
        played: PlayedSound | None = None,
    ) -> None:
        self.name = output.name
        self._played = played
        self._output = output
        self._clock = clock or SystemClock()
        self._wait = wait
        self._lock = threading.Lock()
        self._rate = RateChanger(output.rate_hz)
        self._loudness = Loudness()
        self._due: deque[tuple[float, Samples]] = deque()
        self._end_s = 0.0
        self._closed = False

    @property
    def fault(self) -> str:
        """The reason why the sound goes nowhere at the moment; empty otherwise."""
        return fault_of(self._output)

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        with self._lock:
            start_s = max(self._clock.now(), self._end_s)
            if token.cancelled or self._closed:
                return start_s
            self._accept(self._rate.push(chunk), start_s)
        self._wait_until(AHEAD_S, token)
        return start_s

    def drain(self, token: CancelToken) -> None:
        with self._lock:
            if not token.cancelled and not self._closed:
                self._accept(self._rate.flush(), max(self._clock.now(), self._end_s))
        self._wait_until(0.0, token)

    def stop(self) -> float:
        with self._lock:
            now_s = self._clock.now()
            self._hand_over(now_s)
            self._due.clear()
            self._rate.flush()
            self._loudness.clear()
            if self._played:
                self._played.cut(now_s + self._output.lead_s)
            left_s = max(0.0, self._end_s - now_s)
            self._end_s = now_s
            return left_s

    def audible(self) -> float:
        with self._lock:
            return self._loudness.at(self._clock.now())

    def close(self) -> None:
        with self._lock:
            if not self._closed:
                self._closed = True
                self._hand_over(self._clock.now())
                self._due.clear()
                self._end_s = 0.0
                self._output.close()

    def _accept(self, samples: Samples, start_s: float) -> None:
        rate_hz = self._output.rate_hz
        size = max(1, int(self._output.block_s * rate_hz))
        for at in range(0, len(samples), size):
            block = samples[at : at + size]
            self._due.append((start_s + at / rate_hz, block))
            self._loudness.add(start_s + (at + len(block)) / rate_hz, block)
        self._end_s = start_s + len(samples) / rate_hz
        if self._played and len(samples):
            self._played.add(samples, rate_hz, start_s)
        self._hand_over(self._clock.now())

    def _hand_over(self, now_s: float) -> None:
        """Give the output the blocks that have begun."""
        now_s += self._output.lead_s
        while self._due and self._due[0][0] <= now_s:
            start_s, block = self._due.popleft()
            self._output.write(block, start_s)

    def _wait_until(self, ahead_s: float, token: CancelToken) -> None:
        """Block while more than `ahead_s` is still to be played, handing over what gets due."""
        while not token.cancelled:
            with self._lock:
                now_s = self._clock.now()
                self._hand_over(now_s)
                left_s = self._end_s - now_s - ahead_s
            if left_s < NOTHING_S:
                return
            self._wait(token, min(left_s, self._output.block_s))


BLOCK_S = 0.04
LEAD_S = 0.06
"""Seconds of sound that wait in the other player's queue, and are still heard after a stop."""


class Relay:
    """An output that sends its sound on at 16 kHz, in blocks, a little before they are due.

    Between utterances it sends nothing. Sound before `connect` is lost.
    """

    name = "audio_out"
    rate_hz = RATE_HZ
    block_s = BLOCK_S
    lead_s = LEAD_S

    def __init__(self) -> None:
        self._send: Callable[[Samples], None] | None = None

    def connect(self, send: Callable[[Samples], None]) -> None:
        """Send every block to `send` from now on, on the thread that speaks."""
        self._send = send

    def write(self, samples: Samples, start_s: float) -> None:  # noqa: ARG002
        if self._send:
            self._send(samples)

    def close(self) -> None:
        self._send = None


@dataclass(frozen=True, slots=True)
class Tap:
    """A listener to the played sound.

    Its calls come on the thread that speaks and must not block.
    """

    hear: Callable[[Samples], None]
    """Takes samples at 16 kHz, up to 0.2 s before they are due."""
    cut: Callable[[], None]
    """Called when the sound was cut."""


class TappedSink:
    """Plays on `sink`, as if it were alone. Without listeners, taps cost nothing."""

    def __init__(self, sink: AudioSink) -> None:
        self.name = sink.name
        self._sink = sink
        self._rate = RateChanger(RATE_HZ)
        self._lock = threading.Lock()
        self._taps: tuple[Tap, ...] = ()

    @property
    def fault(self) -> str:
        """The reason why the chosen sink's sound goes nowhere; empty otherwise."""
        return fault_of(self._sink)

    def tap(self, tap: Tap) -> Callable[[], None]:
        """Let it hear from now on; returns a way to forget it."""
        with self._lock:
            self._taps = (*self._taps, tap)
        return lambda: self._forget(tap)

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        if not token.cancelled:
            self._tell(chunk)
        return self._sink.play(chunk, token)

    def drain(self, token: CancelToken) -> None:
        self._tell(None)
        self._sink.drain(token)

    def stop(self) -> float:
        left_s = self._sink.stop()
        with self._lock:
            taps = self._taps
            self._rate.flush()
        for tap in taps:
            tap.cut()
        return left_s

    def audible(self) -> float:
        return self._sink.audible()

    def close(self) -> None:
        self._sink.close()

    def _tell(self, chunk: Chunk | None) -> None:
        """Give the taps this chunk; None for the end of the utterance."""
        with self._lock:
            taps = self._taps
            if not taps:
                self._rate.flush()
                return
            samples = self._rate.push(chunk) if chunk else self._rate.flush()
        if samples.size:
            samples = np.ascontiguousarray(samples)
            for tap in taps:
                tap.hear(samples)

    def _forget(self, tap: Tap) -> None:
        with self._lock:
            self._taps = tuple(one for one in self._taps if one is not tap)
