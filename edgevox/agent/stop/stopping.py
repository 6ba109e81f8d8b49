"""Stopping: a stop word, an interrupt or a reset ends everything under way, at once."""

from collections import deque
from collections.abc import Callable

from edgevox.agent import inbox
from edgevox.agent.dialogue.question import OpenQuestion
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.inbox import Inbox
from edgevox.agent.nlu.hearing.near import NearStop
from edgevox.agent.nlu.hearing.sounds import Phonemes
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.text.reasons import because, called_off
from edgevox.agent.turn import StateMachine, Turn
from edgevox.core.agent_events import HeardBy, SafetyPreempted
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.commands import Heard, SpokenOn, StopSpotted, TextInput
from edgevox.core.events import Cause, Interrupted, State, Transcribed
from edgevox.core.files.text import clean
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock
from edgevox.core.reason import Reason

log = get_logger(__name__)

WORD_TAIL_S = 0.4
"""Speech that ends within this time after the spotter heard a stop word counts as that word: the
voice detector hears its echo, and the spotter may be sure before its last sound."""
SAME_WORD_S = 1.0
"""The spotter may report a word up to this long after the voice detector heard the word end."""
KNOWN_MARKS = 64
"""Number of stops and releases remembered with their times: more than happen during one
utterance."""
STANDING = "standing"
_TOLD = ("", STANDING, "stopped", "program_stopped")
"""Names of the sentences said after a stop, in order of weight: of two, the later one is said."""


Answer = Callable[
    [TextInput | Heard, Callable[[TextInput | Heard], None], Callable[[], None]], None
]
"""Takes words, and what to call if this robot answers them, and if another does."""


class Stopping:
    """Stops the robot, on the calling thread, without waiting for the conversation's thread.

    Every stop is the same (`_stop`): it cancels the running turn and its question, forgets the
    utterances that wait or are being transcribed, cancels the goals, halts the body and ends all
    programs. The interlock then refuses any request made before the stop that arrives after it.

    A stop word may be heard twice: the spotter hears its sound, and transcription reads its words
    later. Each of the two stops the robot; the person is told once, after the utterance is over.
    """

    def __init__(
        self,
        bus: Bus,
        clock: Clock,
        *,
        waiting: Inbox,
        states: StateMachine,
        executor: SkillExecutor,
        programs: Programs,
        interlock: Interlock,
        question: OpenQuestion,
        turn: Callable[[], Turn | None],
        phrases: Callable[[], Phrasebook],
        answer: Answer,
        unheard: Callable[[], Reason],
        language: str,
        phonemes: Phonemes | None = None,
    ) -> None:
        """Store the collaborators and listen to the executor and the interlock for stops.

        Args:
            bus: Carries `SafetyPreempted`, `Interrupted` and `Transcribed`.
            clock: Must be the clock that stamps `Heard` and `StopSpotted`.
            waiting: The conversation's inbox; a stop empties it.
            states: The conversation's state machine.
            executor: Runs the goals that a stop cancels.
            programs: The programs that a stop ends.
            interlock: Numbers the stops, so that a request from before one is refused.
            question: The question that waits for an answer; a stop cancels it.
            turn: Returns the running turn, or None.
            phrases: Returns the sentences of the current language.
            answer: Has the words after a stop word answered by one of the robots that heard them.
            unheard: Returns the sentence that the robot is not heard; empty if it is heard.
            language: ISO 639-1 code of the first language whose stop words count.
            phonemes: Pronunciations, to also find misheard stop words while something moves; None
                turns this off.
        """
        self._bus = bus
        self._clock = clock
        self._inbox = waiting
        self._states = states
        self._executor = executor
        self._programs = programs
        self._interlock = interlock
        executor.on_stop(self._skill_called)
        self._marks = deque([(float("-inf"), interlock.mark)], maxlen=KNOWN_MARKS)
        interlock.on_stop(lambda mark: self._marks.append((clock.now(), mark)))
        self._question = question
        self._turn = turn
        self._phrases = phrases
        self._have_answered = answer
        self._unheard = unheard
        self._phonemes = phonemes
        self.set_language(language)
        self._stopped_s = self._spotted_s = self._withdrawn_s = float("-inf")
        self._heard_idle_s = float("-inf")
        self._untold = ""
        self.last: Turn | None = None
        """The last turn that spoken words began."""

    def set_language(self, code: str) -> None:
        """Look for the stop words of this language from now on."""
        self._safety = SafetyWords(code)
        self._near = NearStop(code, self._phonemes) if self._phonemes else None

    def counts(self, heard: Heard) -> bool:
        """True if `heard` holds words that no later stop or withdrawal has made void.

        A stop word always counts. If the words do not count but a stop was spotted in them, this
        call reports that stop, because no later step will.
        """
        counts = bool(heard.text) and (not self._is_past(heard) or self.is_stop(heard.text))
        if heard.spotted and not counts:
            self._tell_spotted(heard.text)
        return counts

    def mark_of(self, heard: Heard) -> int:
        """The interlock's mark at the time when the person began to say this.

        `counts` already drops words from before a stop, by their times. This mark makes the
        interlock refuse motion for words that were said while all motion was forbidden.
        """
        then = [mark for at_s, mark in list(self._marks) if at_s < heard.first_s]
        return max(self._interlock.stopped, then[-1] if then else 0)

    def queue(self, item: inbox.Item, mark: int) -> None:
        """Put the item into the inbox, unless a stop or a withdrawal has made it void."""
        with self._inbox.gate:
            past = isinstance(item, Heard) and self._is_past(item)
            if not past and not self._interlock.outdated(mark):
                self._inbox.put(item, mark)
                return
        log.info("forgotten_for_a_stop", what=type(item).__name__)

    def _is_past(self, heard: Heard) -> bool:
        """True if the words were withdrawn, or begun or ended before the last stop."""
        if heard.ended_s < self._stopped_s or heard.ended_s == self._withdrawn_s:
            return True
        return _begun_before(heard, self._stopped_s)

    def doubts(self, heard: Heard) -> bool:
        """True if the spotter heard a stop word in or after these words while the robot stood.

        The words themselves may have sounded like a stop word, so the robot asks before it moves.
        """
        ended = heard.ended_s < self._heard_idle_s + WORD_TAIL_S
        return ended or _begun_before(heard, self._heard_idle_s)

    def is_stop(self, text: str) -> bool:
        """True if these words would stop the robot."""
        return (self._safety.find(text) or self._opens(text)) is not None

    def hears(self, words: TextInput | Heard) -> bool:
        """Stop if these words hold a stop word; return whether they do."""
        found = self._safety.find(words.text)
        wait = None if found else self._opens(words.text)
        word = found or wait or self._nearly(words)
        if word:
            self._stop_word(word, words, opened=clean(words.text) if wait else "")
        elif isinstance(words, Heard) and words.spotted:
            self._tell_spotted()
        return word is not None

    def _opens(self, text: str) -> str | None:
        """The wait that opens these words: "wait, I wasn't ready".

        None while nothing goes on; a program whose time has not come does not.
        """
        begun = any(one.goal for one in self._programs.kept)
        going_on = self._turn() or self._executor.moving or begun
        return self._safety.opens(text) if going_on else None

    def _nearly(self, words: TextInput | Heard) -> str | None:
        """The stop word that these spoken words sound like; None while nothing moves."""
        if self._near is None or not isinstance(words, Heard) or self._executor.moving is None:
            return None
        return self._near.find(words.text)

    @property
    def _going_on(self) -> bool:
        return bool(self._turn() or self._executor.moving or self._programs.kept)

    def heed(self, sound: StopSpotted | SpokenOn) -> None:
        """Act on a sound at once, before its words are known."""
        if isinstance(sound, StopSpotted):
            self._spotted(sound)
        else:
            self._withdraw(sound.ended_s)

    def _spotted(self, sound: StopSpotted) -> None:
        """Stop for the sound of a stop word, and drop the words that end with it.

        If nothing is going on, the body is halted all the same, since other programs may drive it,
        and earlier utterances that are still being transcribed are forgotten. Words that may only
        have sounded like a stop word are kept and asked about (`doubts`).
        """
        going_on = self._going_on
        when_s = sound.at_s + (WORD_TAIL_S if going_on else -SAME_WORD_S)
        if not going_on:
            self._heard_idle_s = sound.at_s
        stopped, waited = self._stop(because("spotted_stop"), when_s)
        if going_on or stopped:
            self._spotted_s = sound.at_s
            self._bus.publish(SafetyPreempted(sound.word, stopped, HeardBy.SPOTTER))
        with self._inbox.gate:
            self._untold = _weightier(self._untold, _told(stopped=stopped, waited=waited))
        if not sound.goes_on:
            self._tell_spotted()

    def _tell_spotted(self, text: str = "") -> None:
        """Report the result of a spotted stop, once. `text` is the transcript of its words.

        The sentence "nothing moves" is left out: only a stop word that was read as words gets it.
        """
        with self._inbox.gate:
            said, self._untold = self._untold, ""
        if text:
            self._bus.publish(Transcribed(clean(text)))
        self._answer("" if said == STANDING else said)

    def _answer(self, told: str) -> None:
        """Say the sentence with this name; if it is empty, only go back to listening."""
        if told:
            self._inbox.announce(self.in_words(told))
        else:
            self._inbox.put(inbox.Settle())

    def in_words(self, told: str) -> str:
        """The sentence with this name; it claims no stand of a robot that is not heard."""
        phrases, unheard = self._phrases(), self._unheard()
        if not unheard:
            return phrases.say(told)
        sentence = phrases.failure(unheard)
        return sentence if told == STANDING else f"{phrases.say(told)} {sentence}"

    def _stop_word(self, word: str, words: TextInput | Heard, opened: str) -> None:
        """Stop for this word; see `inbox.Stopped` for what is `opened`."""
        said_s, spotted = self._clock.now(), False
        if isinstance(words, Heard):
            said_s, spotted = words.ended_s, words.spotted
            if not spotted and 0.0 <= self._spotted_s - said_s < SAME_WORD_S:
                self._bus.publish(Transcribed(clean(words.text)))  # it has stopped for this word
                self._answer("")
                return
        why = because("heard_stop", word=word)
        stopped, waited = self._stop(why, said_s)  # before anybody is told: telling may block
        self._bus.publish(Transcribed(clean(words.text)))
        with self._inbox.gate:
            untold, self._untold = self._untold, ""
        if stopped or not spotted or untold == STANDING:
            self._bus.publish(SafetyPreempted(word, stopped))
        tell = stopped or untold or not spotted
        told = _weightier(untold, _told(stopped=stopped, waited=waited)) if tell else ""
        before, after = self._safety.around(word, words.text)
        stood = self._safety.before(word, words.text) if told == STANDING else ""
        if after or stood or opened:
            mark, said = self._interlock.mark, "" if told == STANDING else told
            text = self.in_words(said) if said else ""
            self._have_answered(
                words,
                lambda own: self._continue(
                    inbox.Stopped(text, own, stood, opened, before, after), mark
                ),
                lambda: self._answer(said),
            )
        else:
            self._answer(told)

    def _continue(self, stopped: inbox.Stopped, mark: int) -> None:
        with self._inbox.gate:
            if not self._interlock.outdated(mark):
                self._inbox.put(stopped, mark)

    def leave(self, words: TextInput | Heard) -> None:
        """Leave these words to another robot."""
        self._bus.publish(Transcribed(clean(words.text)))
        self._answer("")

    def interrupt(self, reason: str, cause: Cause, *, motion: bool) -> None:
        """Stop everything; without `motion`, only stop talking, because a person wants to speak."""
        if motion:
            self._stop(because("interrupted", reason), self._clock.now())
            self._inbox.put(inbox.Settle())
        else:
            self._hush(reason)
        self._bus.publish(Interrupted(cause))

    def _withdraw(self, ended_s: float) -> None:
        """End only the work begun for the utterance that ended at `ended_s`: its speaker goes on.

        The whole utterance comes again later.
        """
        with self._inbox.gate:
            self._withdrawn_s = ended_s
            self._inbox.withdraw(ended_s)
            turn = self.last
        if turn is None or turn.asked_s != ended_s:
            return
        with self._states.gate:
            if self._executor.withdraw(called_off("spoken_on"), turn):
                self._states.enter(State.INTERRUPTED, turn)
        self._inbox.put(inbox.Settle())

    def stop(self, reason: Reason) -> None:
        """Stop everything and say nothing."""
        self._stop(reason, self._clock.now())
        self._inbox.put(inbox.Settle())

    def call(self, begin: Callable[[], object]) -> None:
        """Stop everything, `begin` the skill `stop`, and say the result."""
        stopped, waited = self._stop(because("called_off"), self._clock.now())
        begin()
        self._answer(_told(stopped=stopped, waited=waited))

    def _skill_called(self, turn: Turn | None) -> None:
        """Stop everything when the skill `stop` is called, as a stop word would.

        If words of this `turn` called it, the turn goes on, and so do the utterances that were
        said after it and wait.
        """
        if turn is None:
            self._stop(because("called_off"), self._clock.now())
            self._inbox.put(inbox.Settle())
        elif turn is self._turn() and not turn.token.cancelled:
            self._stop(because("called_off"), turn.asked_s, within=turn)

    def reset(self) -> None:
        """Stop everything, and forget the conversation so far."""
        self._stop(because("reset"), self._clock.now())
        self._inbox.put(inbox.Forget())
        self._bus.publish(Interrupted(Cause.RESET))

    def _hush(self, reason: str) -> None:
        turn = self._turn()
        with self._states.gate:
            if turn is not None and self._executor.hush(reason, turn):
                self._states.enter(State.INTERRUPTED, turn)

    def _stop(self, reason: Reason, when_s: float, within: Turn | None = None) -> tuple[bool, bool]:
        """Stop everything; return whether anything was stopped, and whether a program waited.

        `when_s` is the time of the request. `within` is the turn that asked; it goes on.
        """
        with self._interlock.stopping(reason):
            ended = self._programs.stop()
            with self._inbox.gate:
                if within:
                    within.mark = self._interlock.mark
                    self._inbox.remark(within.mark)
                else:
                    self._inbox.stop()
                self._stopped_s = max(self._stopped_s, when_s)
                turn = None if within else self._turn()
                asked = self._question.cancel(turn.number if turn else 0)
            with self._states.gate:
                stopped = self._executor.stop(reason, turn) or bool(ended)
                if (stopped or self._states.transcribes) and not within:
                    self._states.enter(State.INTERRUPTED, turn)
        self._question.tell_cancelled(asked)
        ended = [*ended, *self._programs.stop()]  # a program may have been added meanwhile
        self._programs.stopped(ended, reason)
        return stopped, any(one.goal is None for one in ended)


def _begun_before(heard: Heard, stopped_s: float) -> bool:
    """True if the words were begun before the stop; not if they hold the stop word themselves.

    Words that follow a stop word in the same breath count.
    """
    return not heard.spotted and heard.began_s is not None and heard.began_s <= stopped_s


def _told(*, stopped: bool, waited: bool) -> str:
    return ("program_stopped" if waited else "stopped") if stopped else STANDING


def _weightier(one: str, other: str) -> str:
    return max(one, other, key=_TOLD.index)
