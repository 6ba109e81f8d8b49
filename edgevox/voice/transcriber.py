"""The transcriber: turns utterances into words, one after the other, on its own thread."""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

from edgevox.core.clock import Clock
from edgevox.core.commands import Heard, Transcribing, Way
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.speech import Ending, FollowUp
from edgevox.core.spoken_names import without_phrase
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.speech_to_text import SpeechToText, Transcript, stop_first

log = get_logger(__name__)

MAX_WAITING = 8
"""The most utterances that may wait. One more is refused, counted and reported."""

KnownVoice = Callable[[Samples, float], bool]
"""Whether some speech, until a time of the clock, is that of a person who was enrolled."""


@dataclass(frozen=True, slots=True)
class TranscriptionJob:
    """An utterance to transcribe."""

    samples: Samples
    began_s: float
    """The clock's time of the first voiced sample, in seconds."""
    ended_s: float
    """The clock's time of the last voiced sample, in seconds."""
    phrase: str = ""
    """The wake word at its beginning, if any."""
    unaddressed: bool = False
    """Whether it counts only if it tells the robot to stop, or is a follow-up."""
    awaited: bool = False
    """Whether it may be a follow-up."""
    spotted: bool = False
    """Whether a stop word was spotted in its sound."""
    over: bool = False
    """Whether the robot holds its answer for it."""


@dataclass(frozen=True, slots=True)
class _Words:
    """A transcript, of the speech until `ended_s`, and the seconds that it took."""

    said: Transcript
    ended_s: float
    language: str
    took_s: float
    way: Way
    ending: Ending = Ending.OPEN


class Transcriber:
    """Submits `Transcribing` and then `Heard` for each utterance, always in this order.

    An utterance that may be over is transcribed during the silence that ends it, so that its words
    are ready by then. An unaddressed job submits `Heard` alone, and only if `is_stop` finds a stop
    word or `follow_up` takes it; if a stop word was spotted by its sound, then without words if
    neither does. `submit` must not raise. `stop_stt` transcribes these jobs, by default as all
    others: what may not be for the robot need not leave it. `known` must not raise; without it
    every voice is known.
    """

    def __init__(
        self,
        stt: SpeechToText,
        submit: Callable[[Transcribing | Heard], None],
        *,
        language: Callable[[], str],
        is_stop: Callable[[str], bool],
        clock: Clock,
        ending: Callable[[str], Ending] = lambda _: Ending.OPEN,
        stop_stt: SpeechToText | None = None,
        follow_up: FollowUp | None = None,
        known: KnownVoice | None = None,
    ) -> None:
        self._known = known
        self._stt = stt
        self._stop_stt = stop_stt or stt
        self._submit = submit
        self._language = language
        self._is_stop = is_stop
        self._ending = ending
        self._follow_up = follow_up
        self._clock = clock
        self._jobs: deque[TranscriptionJob] = deque()
        self._early: TranscriptionJob | None = None
        self._guessing = False
        self._told = False
        self._guess: _Words | None = None
        self._changed = threading.Condition()
        self._busy = self._closed = False
        self.refused = self.failed = 0
        self.last: tuple[float, float] | None = None
        """Seconds that the last words took to be understood, and to be said."""
        self._thread = threading.Thread(target=self._work, name="edgevox-transcription")

    def start(self) -> None:
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Whether its thread runs; also True before it is started and after it is closed."""
        return self._closed or self._thread.ident is None or self._thread.is_alive()

    def close(self) -> None:
        """Forget the waiting jobs; finish the one in progress."""
        with self._changed:
            self._closed = True
            self._early = None
            self._jobs.clear()
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join()

    def take(self, job: TranscriptionJob, *, wait: bool = False) -> bool:
        """Queue an utterance; if too many wait already, refuse it, or `wait` until they do not.

        False if it was refused.
        """
        with self._changed:
            if self._guessing and not self._jobs and not job.unaddressed:
                self._told = True
                self._submit(Transcribing())
            if wait:
                self._changed.wait_for(lambda: len(self._jobs) < MAX_WAITING or self._closed)
            full = len(self._jobs) >= MAX_WAITING
            if not full and not self._closed:
                self._jobs.append(job)
                self._changed.notify_all()
        if full:
            self.refused += 1
            log.warning("speech_refused", refused=self.refused, waiting=MAX_WAITING)
        return not full

    def guess(self, job: TranscriptionJob) -> bool:
        """Find out the words of what may be a whole utterance, if nothing else is to be done."""
        with self._changed:
            free = not self._jobs and not self._busy and not self._closed
            if free:
                self._early = job
                self._changed.notify_all()
            return free

    def ending_at(self, ended_s: float) -> Ending | None:
        """Return how the words that were said until then end; None while they are unknown."""
        guess = self._guess
        return guess.ending if guess and guess.ended_s == ended_s else None

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until every utterance, even a possible one, is transcribed.

        False after a timeout.
        """
        with self._changed:
            return self._changed.wait_for(self._is_idle, timeout_s)

    def _is_idle(self) -> bool:
        return not (self._jobs or self._busy or self._early or self._guessing)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._busy = self._guessing = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._jobs or self._early or self._closed)
                if self._closed:
                    return
                early, self._early = self._early, None
                job = self._jobs.popleft() if self._jobs else None
                self._busy, self._guessing = job is not None, job is None
                self._changed.notify_all()
            try:
                if job:
                    self._understand(job)
                elif early:
                    self._guess = self._judged(self._words(early))
            except Exception:  # a bug: what is said next is understood
                self.failed += 1
                log.exception("speech_to_text_broke")
                if job and (job.spotted or not job.unaddressed):
                    self._submit(Heard("", job.ended_s, spotted=job.spotted, over=job.over))

    def _understand(self, job: TranscriptionJob) -> None:
        if not job.unaddressed and not self._told:
            self._submit(Transcribing())
        self._told = False
        guess, self._guess = self._guess, None
        known = guess and (guess.ended_s, guess.language) == (job.ended_s, self._language())
        words = guess if guess and known else self._words(job)
        said = words.said
        heard = Heard(
            said.text,
            job.ended_s,
            words.took_s,
            way=words.way,
            spotted=job.spotted,
            confidence=said.confidence,
            others=said.others,
            rate=said.rate,
            began_s=job.began_s,
            over=job.over,
        )
        if not job.unaddressed or (bool(said.text) and self._is_for_it(heard, job)):
            self._submit(heard)
        elif job.spotted:
            self._submit(replace(heard, text="", others=(), rate=None))

    def _is_for_it(self, heard: Heard, job: TranscriptionJob) -> bool:
        if self._is_stop(heard.text):
            return True
        takes = self._follow_up.takes if self._follow_up and job.awaited else None
        return takes is not None and takes(heard)

    def _judged(self, words: "_Words") -> "_Words":
        """Return the words with their ending; open if it cannot be judged."""
        try:
            return replace(words, ending=self._ending(words.said.text))
        except Exception:
            log.exception("ending_unjudged")
            return words

    def _words(self, job: TranscriptionJob) -> "_Words":
        """Transcribe the job and measure how long it takes."""
        began_s, language = self._clock.now(), self._language()
        said = self._transcribe(job, language)
        known = self._known is None or self._known(job.samples, job.ended_s)
        took_s = self._clock.now() - began_s
        self.last = (took_s, job.samples.size / RATE_HZ)
        way = Way.VOICE if known else Way.VOICE_GUEST
        return _Words(said, job.ended_s, language, took_s, way)

    def _transcribe(self, job: TranscriptionJob, language: str) -> Transcript:
        """The words; none if they could not be understood, which is logged."""
        try:
            stt = self._stop_stt if job.unaddressed else self._stt
            said = stt.transcribe(job.samples, language)
        except EdgeVoxError as error:
            self.failed += 1
            log.error("speech_to_text_failed", reason=str(error))  # noqa: TRY400 - its message says it all
        except Exception:
            self.failed += 1
            log.exception("speech_to_text_broke")
        else:
            return stop_first(_after(job.phrase, said) if job.phrase else said, self._is_stop)
        return Transcript("")


def _after(phrase: str, said: Transcript) -> Transcript:
    """Return the transcript after the wake word, in every hypothesis."""
    others, stops = (
        tuple(replace(one, text=without_phrase(one.text, phrase)) for one in several)
        for several in (said.others, said.stops)
    )
    return replace(said, text=without_phrase(said.text, phrase), others=others, stops=stops)
