"""Speech output: sentences in, sound out, on two threads of its own.

One thread synthesises and may run ahead of the other, which plays; so a sentence is synthesised
while the one before it is heard, and the first while the rest of the answer is still generated.
"""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import bound, get_logger, worth_a_line
from edgevox.core.speech import Utterance
from edgevox.voice.audio import AudioSink, Chunk
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.spoken_answer import SpeakingUtterance, play_chunk

log = get_logger(__name__)

MOST_SENTENCES = 256
"""The most sentences that may wait to be synthesised; one more is not spoken."""
HELD_S = 5.0
"""An answer that is held so long goes on, whatever became of the words that it was held for."""
MOST_AHEAD_S = 20.0
"""Seconds of sound that may wait to be played before the synthesis pauses."""

SENTENCES_SAID = 3
"""The number of latest sentences that count as being said: a short one is over before its echo
is."""


@dataclass(frozen=True, slots=True)
class _Sentence:
    utterance: SpeakingUtterance
    line: int
    text: str


@dataclass(frozen=True, slots=True)
class _Sound:
    utterance: SpeakingUtterance
    line: int
    chunk: Chunk


@dataclass(frozen=True, slots=True)
class _End:
    utterance: SpeakingUtterance


@dataclass(frozen=True, slots=True)
class _Prepare:
    done: threading.Event


class SpeechOutput:
    """A `TextToSpeech`. `begin` may be called from any thread; every utterance must be finished.

    The maker of the sink closes it, after this.
    """

    def __init__(
        self, synthesiser: SentenceSynthesiser, sink: AudioSink, *, clock: Clock | None = None
    ) -> None:
        self.synthesiser = synthesiser
        self._sink = sink
        self._clock = clock or SystemClock()
        self._changed = threading.Condition()
        self._jobs: deque[_Sentence | _End | _Prepare] = deque()
        self._sounds: deque[_Sound | _End] = deque()
        self._ahead_s = 0.0
        self._played: tuple[str, ...] = ()
        self._open: list[SpeakingUtterance] = []
        self._held: SpeakingUtterance | None = None
        self._unplayed_s = 0.0
        self._closed = False
        self.refused = 0
        self.failed = 0
        self._threads = (
            threading.Thread(target=self._synthesise, name="edgevox-synthesis"),
            threading.Thread(target=self._play, name="edgevox-playback"),
        )

    def start(self) -> None:
        """Be able to speak. The voice is loaded with the first sentence, or by `warm_up`."""
        for thread in self._threads:
            thread.start()

    @property
    def alive(self) -> bool:
        """Whether its threads run; also True before they are started and after they are closed."""
        return self._closed or all(one.ident is None or one.is_alive() for one in self._threads)

    def saying(self) -> str:
        """The sentences that are played now, or were last."""
        return " ".join(self._played)

    def warm_up(self) -> None:
        """Load the present voice, and wait for it."""
        self.prepare().wait()

    def prepare(self) -> threading.Event:
        """Load the present voice, after what is to be said; the event is set when it is there."""
        with self._changed:
            waiting = [job for job in self._jobs if isinstance(job, _Prepare)]
        if waiting:  # it will ask for the voice of that moment, and so does for this one
            return waiting[0].done
        done = threading.Event()
        self._put(_Prepare(done))
        return done

    def begin(self, token: CancelToken, on_audible: Callable[[], object]) -> Utterance:
        utterance = SpeakingUtterance(
            token, on_audible, self._say, lambda one: self._put(_End(one))
        )
        with self._changed:
            self._open.append(utterance)
        utterance.token.on_cancel(self._wake)
        return utterance

    def hold(self) -> None:
        """Implements `TextToSpeech`."""
        with self._changed:
            held = self._held = next(iter(self._open), None)
        if held:
            self._note_unplayed(self._silence())

    def release(self) -> None:
        """Implements `TextToSpeech`."""
        with self._changed:
            self._held = None
            self._changed.notify_all()

    def close(self) -> None:
        """Fall silent at once and wait for the threads."""
        with self._changed:
            self._closed = True
            open_now = list(self._open)
            self._changed.notify_all()
        for utterance in open_now:
            utterance.token.cancel("shutting down")
        for thread in self._threads:
            if thread.is_alive():
                thread.join()
        self._settle_cut()
        self._drop_jobs()

    def _say(self, utterance: SpeakingUtterance, line: int, text: str) -> None:
        with self._changed:
            full = len(self._jobs) >= MOST_SENTENCES
            self.refused += full
        if full:
            log.warning("sentences_refused", refused=self.refused, waiting=MOST_SENTENCES)
        else:
            self._put(_Sentence(utterance, line, text))

    def _put(self, job: _Sentence | _End | _Prepare) -> None:
        with self._changed:
            if not self._closed:
                self._jobs.append(job)
                self._changed.notify_all()
                return
        if isinstance(job, _Prepare):
            job.done.set()
        else:
            job.utterance.token.cancel("shut down")
            self._settle_cut()

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify_all()

    # the thread that synthesises

    def _synthesise(self) -> None:
        while (job := self._next_job()) is not None:
            with bound(**({} if isinstance(job, _Prepare) else job.utterance.ids)):
                self._try(job)

    def _try(self, job: _Sentence | _End | _Prepare) -> None:
        try:
            self._do(job)
        except Exception:  # noqa: BLE001 - it is logged
            self._survive("synthesis")

    def _do(self, job: _Sentence | _End | _Prepare) -> None:
        match job:
            case _Prepare(done=done):
                try:
                    self.synthesiser.prepare()
                finally:
                    done.set()
            case _End(utterance=utterance):
                self._pass_on(job, utterance)
            case _Sentence(utterance=utterance, line=line, text=text):
                for chunk in self.synthesiser.speak(utterance, line, text):
                    self._pass_on(_Sound(utterance, line, chunk), utterance)

    def _next_job(self) -> _Sentence | _End | _Prepare | None:
        with self._changed:
            self._changed.wait_for(lambda: self._jobs or self._closed)
            return None if self._closed else self._jobs.popleft()

    def _pass_on(self, item: _Sound | _End, utterance: SpeakingUtterance) -> None:
        """Queue for playing; blocks while too much is waiting."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._ahead_s < MOST_AHEAD_S or utterance.token.cancelled or self._closed
            )
            if not utterance.token.cancelled and not self._closed:
                self._sounds.append(item)
                self._ahead_s += _seconds(item)
                self._changed.notify_all()

    # the thread that plays

    def _play(self) -> None:
        while True:
            item = self._next_sound()
            self._settle_cut()
            if item is None:
                if self._closed:
                    return
            else:
                try:
                    self._put_out(item)
                except Exception:  # noqa: BLE001 - it is logged
                    self._survive("playback")
                    self._settle(item.utterance)

    def _put_out(self, item: _Sound | _End) -> None:
        if isinstance(item, _End):
            self._sink.drain(item.utterance.token)
            self._settle(item.utterance, to_the_end=True)
        elif not item.utterance.settled:
            self._note_sentence(item.utterance.log.sentence(item.line))
            held = partial(self._hold_back, item.utterance)
            play_chunk(item.chunk, item.line, item.utterance, self._sink, held)

    def _hold_back(self, utterance: SpeakingUtterance) -> float | None:
        """Wait while it is held; the seconds that were not played, None if it was not held."""
        if self._held is not utterance:
            return None
        self._note_unplayed(self._silence())
        with self._changed:
            self._changed.wait_for(
                lambda: self._held is not utterance or utterance.token.cancelled or self._closed,
                HELD_S,
            )
            self._held = None
            unplayed_s, self._unplayed_s = self._unplayed_s, 0.0
            return unplayed_s

    def _note_unplayed(self, seconds: float) -> None:
        with self._changed:
            self._unplayed_s += seconds

    def _note_sentence(self, sentence: str) -> None:
        if not self._played or self._played[-1] != sentence:
            self._played = (*self._played[1 - SENTENCES_SAID :], sentence)

    def _next_sound(self) -> _Sound | _End | None:
        """Return the next sound to play; None if the output was closed or the utterance cut."""
        with self._changed:
            self._changed.wait_for(lambda: self._sounds or self._closed or self._any_cut())
            if self._closed or self._any_cut() or not self._sounds:
                return None
            item = self._sounds.popleft()
            self._ahead_s -= _seconds(item)
            self._changed.notify_all()
            return item

    def _any_cut(self) -> bool:
        return any(utterance.token.cancelled for utterance in self._open)

    def _settle_cut(self) -> None:
        """Fall silent if an utterance was cut, and forget what was left of it."""
        with self._changed:
            cut = [utterance for utterance in self._open if utterance.token.cancelled]
        for utterance in cut:
            self._settle(utterance)

    def _settle(self, utterance: SpeakingUtterance, *, to_the_end: bool = False) -> None:
        unplayed_s = self._silence() if utterance.token.cancelled else 0.0
        cut = unplayed_s > 0.0 or not to_the_end
        with self._changed:
            if utterance not in self._open:
                return
            self._open.remove(utterance)
            if self._held is utterance:
                self._held, self._unplayed_s = None, 0.0
            self._sounds = deque(one for one in self._sounds if one.utterance is not utterance)
            self._ahead_s = sum(_seconds(one) for one in self._sounds)
            self._changed.notify_all()
        utterance.settle(cut=cut, unplayed_s=unplayed_s)

    def _silence(self) -> float:
        try:
            return self._sink.stop()
        except Exception:  # noqa: BLE001 - it is logged
            self._survive("playback")
            return 0.0

    def _survive(self, what: str) -> None:
        """Count and log an error.

        An utterance must not wait for ever for a broken voice or loudspeaker.
        """
        self.failed += 1
        if worth_a_line(self.failed):
            log.exception("mouth_failed", what=what, failed=self.failed)

    def _drop_jobs(self) -> None:
        for job in self._jobs:
            if isinstance(job, _Prepare):
                job.done.set()
        self._jobs.clear()


def _seconds(item: _Sound | _End) -> float:
    return len(item.chunk.samples) / item.chunk.rate_hz if isinstance(item, _Sound) else 0.0
