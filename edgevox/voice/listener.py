"""The listener: turns a source of sound into commands for the conversation."""

import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import (
    Command,
    Heard,
    Interrupt,
    SpokenOn,
    SpokenOver,
    StopSpotted,
    Transcribing,
)
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import Cause, WakeWordHeard
from edgevox.core.hearers import UtteranceHeard
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.settings import Echo
from edgevox.core.speech import Ending, FollowUp
from edgevox.voice.audio import (
    FRAME_S,
    RATE_HZ,
    AudioSource,
    EndOfSound,
    Frame,
    LevelMeter,
    UtteranceOver,
    loudness_db,
)
from edgevox.voice.echo.canceller import VoiceOverEcho, open_echo
from edgevox.voice.echo.gate import Unechoed
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.noise_floor import NoiseFloor, speech_db
from edgevox.voice.stop_spotter.detector import StopDetector, StopWatch
from edgevox.voice.stt.speech_to_text import SpeechToText
from edgevox.voice.transcriber import KnownVoice, Transcriber, TranscriptionJob
from edgevox.voice.utterance_end import (
    ENDS_AFTER_S,
    VOICED,
    Endpointer,
    SpeechBegan,
    SpeechEnded,
    SpeechPaused,
    SpeechWentOn,
)
from edgevox.voice.vad import VoiceDetector
from edgevox.voice.wake.gate import WakeDecision, WakeGate
from edgevox.voice.word_detection import WakeDetector

log = get_logger(__name__)


class Telling:
    """Submits commands.

    An error of the receiver is counted and logged, and the next command follows.
    """

    def __init__(self, submit: Callable[[Command], None]) -> None:
        self._submit = submit
        self.failed = 0

    def __call__(self, command: Command) -> None:
        try:
            self._submit(command)
        except Exception:
            self.failed += 1
            log.exception("command_untaken", command=type(command).__name__)


READ_S = 0.25
STALLED_S = 1.0
"""A source that gives nothing for this long ends the current utterance."""
INTERRUPTS_FROM_FRAMES = round(1.0 / FRAME_S)
"""Longer speech over the robot is no "mm-hm": it interrupts before its words are known."""
QUIETER_DB = 6.0
"""A follow-up may be this much quieter than the words before it: one who turns away is, and one
who is twice as far away is not taken for that person."""


class Listener:
    """Hears a source of sound, on one thread, and transcribes it on another.

    Submits, from these threads: `Transcribing` and then `Heard` for each utterance; `SpokenOver` as
    soon as a person speaks over the robot, and `Interrupt`, without motion, once that is more than
    an "mm-hm"; `StopSpotted` as soon as `stop_detector` hears a stop word, with a wake word or
    without.

    A fixed silence ends an utterance unless `ending` judges its words. With `ending`, a plain
    command is `Heard` at once; if the person speaks on within `GOES_ON_S`, `SpokenOn` takes it
    back, and the whole utterance is `Heard` later. Waiting instead would delay every command for
    the few that go on; acting on both parts would do now what may be meant for later ("go to the
    kitchen, in ten minutes").

    Args:
        source: Where the sound comes from.
        vad: Tells voiced frames.
        stt: Turns utterances into words.
        stop_stt: Turns unaddressed utterances into words; `stt` by default.
        submit: Takes each command; its errors are logged and counted.
        bus: Gets `WakeWordHeard` and the sound level.
        language: The ISO 639-1 code of the language that is spoken now.
        muted: While True, nothing is heard and no level is published.
        audible: How loud the robot itself plays now, root mean square, 0 to 1.
        wakeword: Detects the wake word; speech without it is ignored, see `wake/gate.py`. None
            takes all speech.
        is_stop: Whether these words stop the robot.
        follow_up: Tells which words count without the wake word, shortly after the robot spoke, if
            they are as loud as the words before. None if only stop words do.
        known: Whether a voice is that of a person who was enrolled; None takes all for such.
        stop_detector: Spots stop words in the sound, before the utterance ends.
        saying: What the robot says now, so that it does not stop itself.
        ending: Judges by its words whether an utterance is complete. None, in a file, and where the
            wake word is missing: a fixed silence.
        echo: How the robot's own voice is kept out: "cancel", "gate" or "none".
        on_utterance: Takes how well an utterance is heard, before its words are known.
        played: The robot's own sound, the reference for "cancel".
        lossless: Wait for the transcriber instead of refusing utterances that it cannot keep up
            with. For files, never for a microphone.
        clock: The time of the frames; the system's by default.
    """

    def __init__(
        self,
        source: AudioSource,
        vad: VoiceDetector,
        stt: SpeechToText,
        *,
        submit: Callable[[Command], None],
        bus: Bus,
        language: Callable[[], str],
        muted: Callable[[], bool],
        audible: Callable[[], float],
        wakeword: WakeDetector | None = None,
        is_stop: Callable[[str], bool] = lambda _: False,
        stop_stt: SpeechToText | None = None,
        follow_up: FollowUp | None = None,
        known: KnownVoice | None = None,
        stop_detector: StopDetector | None = None,
        saying: Callable[[], str] = lambda: "",
        ending: Callable[[str], Ending] | None = None,
        echo: Echo = "gate",
        on_utterance: Callable[[UtteranceHeard], None] | None = None,
        played: PlayedSound | None = None,
        lossless: bool = False,
        clock: Clock | None = None,
    ) -> None:
        self._source = source
        self._voices = VoiceOverEcho(vad)
        self._wakeword = wakeword
        self._bus = bus
        self._muted = muted
        self._lossless = lossless
        self._clock = clock or SystemClock()
        self._meter = LevelMeter(bus.publish)
        self._echo = open_echo(echo, audible, played)
        self._noise = NoiseFloor()
        self._on_utterance = on_utterance
        self._endpointer = Endpointer()
        self._wake_gate = WakeGate()
        self._stops = stop_detector and StopWatch(stop_detector, saying=saying, language=language)
        self._spotted = False
        self._tell = Telling(submit)
        self._transcriber = Transcriber(
            stt,
            self._tell,
            language=language,
            is_stop=is_stop,
            clock=self._clock,
            ending=ending or (lambda _: Ending.OPEN),
            stop_stt=stop_stt,
            follow_up=follow_up,
            known=known,
        )
        self._follow_up = follow_up
        self._person_db: float | None = None
        self._over_frames: int | None = None
        self._judges = ending is not None and not lossless
        self._last_s: float | None = None
        self._addressed_s = float("-inf")
        self._closing = threading.Event()
        self._over = threading.Event()
        self._heard_all = False
        self._unheard = 0
        self._thread = threading.Thread(target=self._listen, name="edgevox-listener")

    def start(self) -> None:
        """Begin to listen."""
        self._transcriber.start()
        self._source.start()
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Whether its threads run; also True before `start` and after an orderly end."""
        over = self._closing.is_set() or self._heard_all or self._thread.ident is None
        return (over or self._thread.is_alive()) and self._transcriber.alive

    @property
    def failed(self) -> int:
        """Pieces of sound that were lost to an error, or commands that were not taken."""
        return self._unheard + self._tell.failed

    @property
    def transcriber(self) -> Transcriber:
        """The thread that turns utterances into words."""
        return self._transcriber

    def close(self) -> None:
        """Stop listening; finish the transcription in progress, and forget the waiting ones."""
        self._closing.set()
        self._source.close()
        if self._thread.is_alive():
            self._thread.join()
        self._transcriber.close()

    def wait_over(self, timeout_s: float | None = None) -> bool:
        """Block until the source has no more and all of it is understood; False after a timeout."""
        return self._over.wait(timeout_s) and self._transcriber.wait_idle(timeout_s)

    def _listen(self) -> None:
        try:
            while not self._closing.is_set():
                self._hear_next()
        except EndOfSound as end:
            self._heard_all = True
            log.info("sound_over", why=str(end))
        except EdgeVoxError as error:
            log.error("hearing_ended", reason=str(error))  # noqa: TRY400 - its message says it all
        finally:
            self._finish()
            self._over.set()

    def _hear_next(self) -> None:
        try:
            frame = self._source.read(READ_S)
        except UtteranceOver as over:
            attend = self._forget if over.abandoned else self._finish
        else:
            attend = partial(self._attend, frame)
        if not self._went_well(attend):
            self._went_well(self._forget)

    def _went_well(self, attend: Callable[[], None]) -> bool:
        """Return whether `attend` succeeded.

        An error is counted and logged, and hearing goes on.
        """
        try:
            attend()
        except Exception:
            self._unheard += 1
            if worth_a_line(self._unheard):
                log.exception("frame_unheard", failed=self._unheard)
            return False
        return True

    def _attend(self, frame: Frame | None) -> None:
        """Hear it; None where nothing came, which ends an utterance after a while."""
        if frame is None:
            if self._last_s is not None and self._clock.now() - self._last_s > STALLED_S:
                self._finish()
        elif self._muted():
            self._forget()
        else:
            self._hear(frame)

    def _hear(self, frame: Frame) -> None:
        if self._last_s is not None and frame.end_s - self._last_s > STALLED_S:
            self._finish()
        self._last_s = frame.end_s
        if frame.addressed:
            self._addressed_s = frame.end_s
        self._meter.push(frame.samples)
        sound = self._echo.hear(frame)
        probability, surmised = self._voices.of(sound)
        clean = Frame(sound.clean, frame.end_s)
        self._listen_for_stop_word(clean, loud=_is_somebody(sound, probability))
        self._listen_for_wake_word(clean, probability)
        self._wait_as_long_as_words_want()
        words = Frame(sound.words, frame.end_s)
        if self._on_utterance and not self._echo.playing:
            self._noise.push(sound.words, self._voices.any_voice)
        match self._endpointer.push(words, probability, surmised=surmised):
            case SpeechBegan(began_s=began_s):
                if self._follow_up:
                    self._follow_up.begins()
                self._speak_over(began_s)
            case SpeechPaused() as speech:
                self._guess(speech)
            case SpeechWentOn(ended_s=ended_s):
                self._tell(SpokenOn(ended_s))
                self._speak_over(frame.end_s)
            case SpeechEnded() as speech:
                self._take(speech)
        if self._over_frames is not None:
            self._over_frames += 1
            if self._over_frames > INTERRUPTS_FROM_FRAMES and self._endpointer.paused_at is None:
                self._interrupt()
        if self._spotted and not self._endpointer.speaking:
            self._tell_spotted(frame.end_s)

    def _guess(self, speech: SpeechPaused) -> None:
        job = self._job(speech)
        if not job or (job.unaddressed and not job.awaited):
            return
        self._tell_heard(speech)
        if self._transcriber.guess(job) and self._judges:
            self._endpointer.end_after(ENDS_AFTER_S[Ending.BROKEN_OFF])

    def _wait_as_long_as_words_want(self) -> None:
        """A whole command ends at once, and what breaks off waits, once the words are known."""
        paused_at = self._endpointer.paused_at if self._judges else None
        ending = None if paused_at is None else self._transcriber.ending_at(paused_at)
        if ending:
            plain = ending in (Ending.WHOLE, Ending.MAY_GO_ON)
            self._endpointer.end_after(ENDS_AFTER_S[ending], revocable=plain)

    def _listen_for_stop_word(self, frame: Frame, *, loud: bool) -> None:
        """Spot stop words in the sound before the echo gate.

        The gate would cut a word's beginning.
        """
        if self._stops and self._stops.heard(
            frame.samples, self._voices.any_voice, playing=self._echo.playing, loud=loud
        ):
            self._spotted = self._endpointer.speaking
            self._tell(StopSpotted(frame.end_s, self._stops.word, goes_on=self._spotted))

    def _tell_spotted(self, now_s: float) -> None:
        """End the utterance in which a stop word was spotted; its words do not count."""
        self._spotted = False
        self._tell(Transcribing())
        self._tell(Heard("", now_s, spotted=True))

    def _listen_for_wake_word(self, frame: Frame, probability: float) -> None:
        if self._wakeword is None:
            return
        # It knows its phrase through the robot's own voice, so the echo gate is not for it.
        chance = 1.0 if self._echo.playing else probability
        if self._wakeword.heard(frame.samples, chance):
            self._wake_gate.wake(frame.end_s)
            self._bus.publish(WakeWordHeard(self._wakeword.phrase))
            if self._echo.playing:
                self._tell(Interrupt("heard the wake word", motion=False, cause=Cause.WAKE_WORD))

    def _speak_over(self, began_s: float) -> None:
        """Silence the robot: at once if the speech is meant for it, else until its words are known.

        Whoever holds a talk button, or said the wake word, wants to be heard.
        """
        if not self._echo.playing:
            return
        if self._is_pressed(began_s) or self._wake_gate.has(began_s):
            self._interrupt()
        elif self._wakeword is None:
            self._over_frames = 0
            self._tell(SpokenOver())

    def _interrupt(self) -> None:
        self._over_frames = None
        self._tell(Interrupt("spoken over", motion=False, cause=Cause.BARGE_IN))

    def _is_addressed(self, began_s: float) -> bool:
        """Return whether speech since then needs no wake word."""
        return self._wakeword is None or self._is_pressed(began_s)

    def _is_pressed(self, began_s: float) -> bool:
        """Return whether the speaker has held a talk button since then."""
        return self._addressed_s > began_s + FRAME_S / 2

    def _take(self, speech: SpeechEnded) -> None:
        job = self._job(speech)
        if job is None:
            return
        if not job.unaddressed or job.awaited:
            self._tell_heard(speech)
        if self._wakeword is not None and not job.unaddressed:
            self._person_db = loudness_db(speech.samples)
            if not self._is_pressed(speech.began_s):
                self._wake_gate.take(speech)
        self._understand(job)

    def _job(self, speech: SpeechEnded | SpeechPaused) -> TranscriptionJob | None:
        """Return the transcription job for this speech, or None if it is not for the robot."""
        if self._wakeword is None or self._is_addressed(speech.began_s):
            return TranscriptionJob(speech.samples, speech.began_s, speech.ended_s)
        awaited = self._awaits(speech)
        match self._wake_gate.judge(speech, awaited=awaited):
            case WakeDecision.TAKE:
                start_s = self._wake_gate.phrase_from(speech)
                phrase = "" if start_s is None else self._wakeword.phrase
                samples = speech.samples[round((start_s or 0.0) * RATE_HZ) :]
                return TranscriptionJob(samples, speech.began_s, speech.ended_s, phrase)
            case WakeDecision.UNADDRESSED:
                return TranscriptionJob(
                    speech.samples,
                    speech.began_s,
                    speech.ended_s,
                    unaddressed=True,
                    awaited=awaited,
                )
        return None

    def _tell_heard(self, speech: SpeechEnded | SpeechPaused) -> None:
        if self._on_utterance is None:
            return
        floor_db = self._noise.floor_db
        self._on_utterance(
            UtteranceHeard(
                speech.began_s,
                speech.ended_s,
                0.0 if floor_db is None else speech_db(speech.samples) - floor_db,
                self._wake_gate.woken_for(speech),
                asked=self._follow_up is not None and self._follow_up.asked(speech.ended_s),
            )
        )

    def _awaits(self, speech: SpeechEnded | SpeechPaused) -> bool:
        """Return whether it may be a follow-up: at its time, and as loud as the person before."""
        if self._follow_up is None or self._person_db is None:
            return False
        if not self._follow_up.awaits(speech.began_s, speech.ended_s):
            return False
        return loudness_db(speech.samples) >= self._person_db - QUIETER_DB

    def _understand(self, job: TranscriptionJob) -> None:
        over = self._over_frames is not None
        asked = replace(job, spotted=self._spotted, over=over)
        taken = self._transcriber.take(asked, wait=self._lossless)
        self._spotted = self._spotted and not taken
        if over and not taken:
            self._interrupt()
        self._over_frames = None

    def _finish(self) -> None:
        """End the utterance that is going on: the next sound does not follow on it."""
        if speech := self._endpointer.finish():
            self._take(speech)
        self._forget()

    def _forget(self) -> None:
        if self._last_s is None:
            return
        heard_s, self._last_s = self._last_s, None
        if self._over_frames is not None:
            self._interrupt()
        if self._stops:
            self._stops.forget()
        self._meter.reset()
        self._endpointer.reset()
        self._wake_gate.reset()
        self._voices.reset()
        if self._wakeword is not None:
            self._wakeword.reset()
        if self._spotted:
            self._tell_spotted(heard_s)


def _is_somebody(sound: Unechoed, probability: float) -> bool:
    """Return whether the sound holds a person's voice, not the robot's own."""
    return probability >= VOICED if sound.cancelled else bool(sound.voice.any())
