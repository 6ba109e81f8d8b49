"""Turning utterances into words, one after the other, on a thread of its own."""

import logging
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from edgevox.core.clock import Clock
from edgevox.core.commands import Heard, Transcribing
from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import Samples
from edgevox.voice.stt.base import SpeechToText
from edgevox.voice.wakephrase import without_phrase

log = logging.getLogger(__name__)

MAX_WAITING = 8
"""So many utterances may wait. One more is refused, counted and said."""


@dataclass(frozen=True, slots=True)
class Job:
    """An utterance to understand. `ended_s` is the clock's time of its last voiced sample.

    `phrase` is the wake word that stands at its beginning, if any; with `only_stop` it counts only
    if it tells the robot to stop.
    """

    samples: Samples
    ended_s: float
    phrase: str = ""
    only_stop: bool = False


class Understanding:
    """Submits `Transcribing` and then `Heard` for each utterance, always in turns.

    One with `only_stop` submits `Heard` alone, and only if `is_stop` finds a stop word in it.
    """

    def __init__(
        self,
        stt: SpeechToText,
        submit: Callable[[Transcribing | Heard], None],
        *,
        language: Callable[[], str],
        is_stop: Callable[[str], bool],
        clock: Clock,
    ) -> None:
        self._stt = stt
        self._submit = submit
        self._language = language
        self._is_stop = is_stop
        self._clock = clock
        self._jobs: deque[Job] = deque()
        self._changed = threading.Condition()
        self._busy = self._closed = False
        self.refused = self.failed = 0
        self._thread = threading.Thread(target=self._work, name="edgevox-transcription")

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Forget what waits; wait for what is being understood."""
        with self._changed:
            self._closed = True
            self._jobs.clear()
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join()

    def take(self, job: Job, *, wait: bool = False) -> None:
        """Queue an utterance; if too many wait already, refuse it, or `wait` until they do not."""
        with self._changed:
            if wait:
                self._changed.wait_for(lambda: len(self._jobs) < MAX_WAITING or self._closed)
            full = len(self._jobs) >= MAX_WAITING
            if not full and not self._closed:
                self._jobs.append(job)
                self._changed.notify_all()
        if full:
            self.refused += 1
            log.warning("%d utterances were not understood: too many wait", self.refused)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until every utterance is understood; False after the timeout."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._jobs and not self._busy, timeout_s)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._jobs or self._closed)
                if self._closed:
                    return
                job = self._jobs.popleft()
                self._busy = True
                self._changed.notify_all()
            self._understand(job)

    def _understand(self, job: Job) -> None:
        if not job.only_stop:
            self._submit(Transcribing())
        began_s = self._clock.now()
        text = self._words(job)
        if not job.only_stop or (text and self._is_stop(text)):
            self._submit(Heard(text, job.ended_s, self._clock.now() - began_s))

    def _words(self, job: Job) -> str:
        """What was said; nothing if it could not be understood, which is logged."""
        try:
            text = self._stt.transcribe(job.samples, self._language())
        except EdgeVoxError as error:
            self.failed += 1
            log.error("speech to text: %s", error)  # noqa: TRY400 - its message says it all
        except Exception:
            self.failed += 1
            log.exception("speech to text failed")
        else:
            return without_phrase(text, job.phrase) if job.phrase else text
        return ""
