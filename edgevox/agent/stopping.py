"""What stops the robot: a stop word, an interrupt, a reset. At once, and whatever is under way."""

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
from edgevox.agent.states import StateMachine
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.text.reasons import because, called_off
from edgevox.agent.turn import Turn
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
"""What was said until so long after the spotter heard a stop word is that word: the voice detector
hears its echo, and the spotter may be sure before its last sound."""
SAME_WORD_S = 1.0
"""The spotter may hear a word so long after the voice detector heard its end."""
KNOWN_MARKS = 64
"""So many stops and releases are remembered with their times: more than come while one speaks."""
_STANDING = "standing"
_TOLD = ("", _STANDING, "stopped", "program_stopped")
"""What is said after a stop; of two, the later in this row."""


class Stopping:
    """Acts on the calling thread, at once, and never waits for the conversation's.

    Every stop is the same (`_stop`): it cancels the `turn` that runs and its `question`, forgets
    the utterances that wait or are being transcribed, cancels the goals, halts the body, ends all
    programs, and has the `interlock` refuse whatever was asked for before and comes only now.

    A stop word may be heard twice: by the spotter, from its sound, and later by its words. Each
    stops; somebody is told once, and when the utterance is over.
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
        language: str,
        phonemes: Phonemes | None = None,
    ) -> None:
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
        self._phonemes = phonemes
        self.set_language(language)
        self._stopped_s = self._spotted_s = self._withdrawn_s = float("-inf")
        self._heard_idle_s = float("-inf")
        self._untold = ""
        self.last: Turn | None = None
        """The last turn that somebody spoke for."""

    def set_language(self, code: str) -> None:
        """Hear stop words of this language."""
        self._safety = SafetyWords(code)
        self._near = NearStop(code, self._phonemes) if self._phonemes else None

    def counts(self, heard: Heard) -> bool:
        """Whether there are words, said neither before a stop nor taken back since.

        Who waits is forgotten with a stop. One that was spotted in words that do not count is told.
        """
        counts = bool(heard.text) and (not self._is_past(heard) or self.is_stop(heard.text))
        if heard.spotted and not counts:
            self._tell_spotted(heard.text)
        return counts

    def mark_of(self, heard: Heard) -> int:
        """The interlock's mark when this was begun to be said.

        What was said before a stop is known by its time (`counts`), as a spoken stop counts from
        when it was said. What is left is what was said while all motion was forbidden.
        """
        began_s = heard.ended_s if heard.began_s is None else heard.began_s
        then = [mark for at_s, mark in list(self._marks) if at_s < began_s]
        return max(self._interlock.stopped, then[-1] if then else 0)

    def queue(self, item: inbox.Item, mark: int) -> None:
        """Let it wait for the conversation, unless a stop, or its taking back, was quicker."""
        with self._inbox.gate:
            past = isinstance(item, Heard) and self._is_past(item)
            if not past and not self._interlock.outdated(mark):
                self._inbox.put(item, mark)
                return
        log.info("forgotten_for_a_stop", what=type(item).__name__)

    def _is_past(self, heard: Heard) -> bool:
        """Whether it was said before a stop, to which also belongs what was begun before it."""
        if heard.ended_s < self._stopped_s or heard.ended_s == self._withdrawn_s:
            return True
        return _begun_before(heard, self._stopped_s)

    def doubts(self, heard: Heard) -> bool:
        """Whether these words may have been taken back by a stop word that only its sound told.

        The robot stood still, so the words may have sounded like one themselves. Whoever said them
        is asked before anything moves.
        """
        ended = heard.ended_s < self._heard_idle_s + WORD_TAIL_S
        return ended or _begun_before(heard, self._heard_idle_s)

    def is_stop(self, text: str) -> bool:
        """Whether these words would stop the robot."""
        return self._safety.find(text) is not None

    def hears(self, words: TextInput | Heard) -> bool:
        """Stop if these words say so; False if they do not."""
        word = self._safety.find(words.text) or self._nearly(words)
        if word:
            self._stop_word(word, words)
        elif isinstance(words, Heard) and words.spotted:
            self._tell_spotted()
        return word is not None

    def _nearly(self, words: TextInput | Heard) -> str | None:
        """The stop word that these sound like, if they were spoken while something moves."""
        if self._near is None or not isinstance(words, Heard) or self._executor.moving is None:
            return None
        return self._near.find(words.text)

    def heed(self, sound: StopSpotted | SpokenOn) -> None:
        """Do at once what a sound asks for, before its words are known."""
        if isinstance(sound, StopSpotted):
            self._spotted(sound)
        else:
            self._withdraw(sound.ended_s)

    def _spotted(self, sound: StopSpotted) -> None:
        """Stop for the sound of a stop word; what ends with it was that word, whatever it reads.

        Where nothing is going on the body is halted all the same, since others may drive it, and
        what was said before and is still being transcribed is forgotten; but words that may only
        have sounded like a stop word are asked about (`doubts`).
        """
        going_on = bool(self._turn() or self._executor.moving or self._programs.kept)
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
        """Say what became of a stop that was spotted, once; `text` is what its words read.

        That nothing moved is told only to who really said the word.
        """
        with self._inbox.gate:
            said, self._untold = self._untold, ""
        if text:
            self._bus.publish(Transcribed(clean(text)))
        self._answer("" if said == _STANDING else said)

    def _answer(self, told: str) -> None:
        """Say what became of a stop; where there is nothing to say, only listen again."""
        if told:
            self._inbox.announce(self._phrases().say(told))
        else:
            self._inbox.put(inbox.Settle())

    def _stop_word(self, word: str, words: TextInput | Heard) -> None:
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
        if stopped or not spotted or untold == _STANDING:
            self._bus.publish(SafetyPreempted(word, stopped))
        tell = stopped or untold or not spotted
        self._answer(_weightier(untold, _told(stopped=stopped, waited=waited)) if tell else "")

    def interrupt(self, reason: str, cause: Cause, *, motion: bool) -> None:
        """Stop everything; without `motion` only what is said: somebody wants to be heard."""
        if motion:
            self._stop(because("interrupted", reason), self._clock.now())
            self._inbox.put(inbox.Settle())
        else:
            self._hush(reason)
        self._bus.publish(Interrupted(cause))

    def _withdraw(self, ended_s: float) -> None:
        """End what was begun for the words until then, and nothing else: they were not all."""
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
        """Stop everything, without a word."""
        self._stop(reason, self._clock.now())
        self._inbox.put(inbox.Settle())

    def call(self, begin: Callable[[], object]) -> None:
        """Stop everything, `begin` the skill `stop`, and say what became of it."""
        stopped, waited = self._stop(because("called_off"), self._clock.now())
        begin()
        self._answer(_told(stopped=stopped, waited=waited))

    def _skill_called(self, turn: Turn | None) -> None:
        """The skill `stop` is as good as the word, whoever calls it.

        Where it was called for in words of this `turn`, that turn goes on, and so does what was
        said after it and waits.
        """
        if turn is None:
            self._stop(because("called_off"), self._clock.now())
            self._inbox.put(inbox.Settle())
        elif turn is self._turn() and not turn.token.cancelled:
            self._stop(because("called_off"), turn.asked_s, within=turn)

    def reset(self) -> None:
        """Stop everything, and forget what was said."""
        self._stop(because("reset"), self._clock.now())
        self._inbox.put(inbox.Forget())
        self._bus.publish(Interrupted(Cause.RESET))

    def _hush(self, reason: str) -> None:
        turn = self._turn()
        with self._states.gate:
            if turn is not None and self._executor.hush(reason, turn):
                self._states.enter(State.INTERRUPTED, turn)

    def _stop(self, reason: Reason, when_s: float, within: Turn | None = None) -> tuple[bool, bool]:
        """Whether there was anything to stop, and whether programs waited for their time.

        `when_s` is when it was asked for, `within` the turn that asked, which goes on.
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
        ended = [*ended, *self._programs.stop()]  # what was being kept when it was asked for
        self._programs.stopped(ended, reason)
        return stopped, any(one.goal is None for one in ended)


def _begun_before(heard: Heard, stopped_s: float) -> bool:
    """What follows a stop word in one breath was begun before it, and counts all the same."""
    return not heard.spotted and heard.began_s is not None and heard.began_s <= stopped_s


def _told(*, stopped: bool, waited: bool) -> str:
    return ("program_stopped" if waited else "stopped") if stopped else _STANDING


def _weightier(one: str, other: str) -> str:
    return max(one, other, key=_TOLD.index)
