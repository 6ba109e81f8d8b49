"""A sink that plays against the clock: speech takes the time that it would take in a room."""

import threading
from collections import deque

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.fault import fault_of
from edgevox.voice.audio import Chunk, Samples
from edgevox.voice.played_sound import PlayedSound
from edgevox.voice.sinks.paced_output import PacedOutput
from edgevox.voice.sinks.pacing import AHEAD_S, NOTHING_S, Loudness, RateChanger, Wait, real_wait


class PacedSink:
    """Gives an output its sound when it is due, and forgets what was not due when it is stopped.

    What an output was given early (`PacedOutput.lead_s`) it may still play after a stop. What it
    plays is told to `played`.
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
        """Why what is played goes nowhere at the moment; empty otherwise."""
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
