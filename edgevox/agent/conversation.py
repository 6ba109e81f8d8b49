"""The conversation: commands in, events out, on one thread; stopping never waits for it."""

import itertools
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any, assert_never

from edgevox.agent import inbox
from edgevox.agent.agents import Agent, skills_of
from edgevox.agent.dialogue.asking import Asking
from edgevox.agent.dialogue.memory import LastDrive
from edgevox.agent.dialogue.performer import Performer
from edgevox.agent.dialogue.question import FollowUps, OpenQuestion
from edgevox.agent.dialogue.skills import DialogueSkills
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.goals.goal import Goal
from edgevox.agent.known import NOTHING_KNOWN, Known
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.hearing.sounds import Phonemes
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.policy import Guard
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.store import Timer
from edgevox.agent.skills import STOP, Call
from edgevox.agent.stop.stopping import STANDING, Stopping
from edgevox.agent.text.reasons import because
from edgevox.agent.turn import InputTiming, StateMachine, Turn
from edgevox.core.agent_events import UtteranceLeft
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import (
    CancelProgram,
    ConversationCommand,
    Heard,
    Interrupt,
    Reset,
    RunSkill,
    Speak,
    SpokenOn,
    SpokenOver,
    StopSpotted,
    TextInput,
    Transcribing,
    Way,
)
from edgevox.core.events import Cause, Outcome, State, Transcribed, TurnEnded
from edgevox.core.files.text import MAX_CHARACTERS, clean
from edgevox.core.hearers import Hearers
from edgevox.core.log import bound, get_logger
from edgevox.core.motion.interlock import Interlock
from edgevox.core.reason import Reason
from edgevox.core.settings import Confirm
from edgevox.core.speech import TextToSpeech

log = get_logger(__name__)


class Conversation:
    """Owns the turns. `submit` and `start_goal` may be called from any thread and never block.

    Stop words, `Interrupt` and `Reset` act on the calling thread, at once (`Stopping`).
    """

    def __init__(
        self,
        agents: Sequence[Agent],
        bus: Bus,
        *,
        halt: Callable[[str], bool],
        model: LanguageModel | None = None,
        speech_output: TextToSpeech | None = None,
        language: str = "en",
        confirm: Confirm = "unsure",
        clock: Clock | None = None,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
        decider: Decider | None = None,
        phonemes: Phonemes | None = None,
        known: Known = NOTHING_KNOWN,
        timer: Timer | None = None,
        follow_up_s: float = 8.0,
        hearers: Hearers | None = None,
    ) -> None:
        """Build the parts of a conversation; `start` starts its threads.

        Args:
            agents: The agents, the first of which speaks first.
            bus: Carries every event of the conversation.
            halt: Brakes the body and tells why; returns whether anything moved.
            model: Answers questions about the world in general; None for no language model.
            speech_output: Speaks the answers; None to only write them.
            language: ISO 639-1 code of the first language.
            confirm: When to ask before the robot moves: see the setting `confirm`.
            clock: The time of everything here; the system's by default.
            interlock: Forbids motion and numbers the stops; one that forbids nothing by default.
            guard: The policy, which may forbid any skill except to stop; None allows all.
            decider: Reads orders that no template fits; None understands only those of templates.
            phonemes: Pronunciations, to recognise misheard words by their sounds.
            known: What the body knows of itself and its world, for answers and for programs.
            timer: Wakes programs at their time; a timer of its own by default.
            follow_up_s: Seconds after a spoken answer in which a person may go on without the wake
                word; 0 for never, not even to answer a question.
            hearers: Decides which robot of a group answers spoken words; None if this one does.
        """
        self._bus = bus
        self._hearers = hearers
        self._clock = clock or SystemClock()
        self._inbox = inbox.Inbox(self._clock)
        dialogue = DialogueSkills(agents, bus, self._clock, lambda: self.interpreter.phrases, known)
        self.interpreter = interpreter = Interpreter(
            dialogue.agents,
            bus,
            self._clock,
            model,
            language,
            decider=decider,
            phonemes=phonemes,
            conditions=known.conditions,
        )
        self._skills = skills_of(agents)
        self._interlock = interlock = interlock or Interlock()
        self._executor = SkillExecutor(
            bus,
            halt,
            self._inbox.announce,
            phrases=lambda: interpreter.phrases,
            interlock=interlock,
            guard=guard,
        )
        self.programs = Programs(
            bus,
            self._executor,
            self._skills,
            announce=self._inbox.announce,
            phrases=lambda: interpreter.phrases,
            clock=self._clock,
            timer=timer,
            known=known,
        )
        last = LastDrive(bus, self._clock)
        performer = Performer(interpreter, self._executor, self.programs, dialogue, last)
        self._question = OpenQuestion(bus, self._clock)
        self._asking = Asking(interpreter, performer, dialogue, self._question, confirm=confirm)
        self.follow_ups = FollowUps(
            self._question, self._asking.replies.follows, self._clock, within_s=follow_up_s
        )
        interlock.on_stop(lambda _: self.follow_ups.close())
        self._numbers = itertools.count(1)
        self._turn: Turn | None = None
        self._held: Turn | None = None
        self._speech_output = speech_output
        self._states = StateMachine(bus)
        self._stopping = Stopping(
            bus,
            self._clock,
            waiting=self._inbox,
            states=self._states,
            executor=self._executor,
            programs=self.programs,
            interlock=interlock,
            question=self._question,
            turn=lambda: self._turn,
            phrases=lambda: interpreter.phrases,
            answer=self._answer,
            unheard=known.unheard,
            language=language,
            phonemes=phonemes,
        )
        self._thread = threading.Thread(target=self._work, name="edgevox-conversation")

    def start(self) -> None:
        """Start the threads and take commands."""
        self._executor.start()
        self.programs.start()
        self._states.start()
        self._thread.start()

    @property
    def alive(self) -> bool:
        """True unless the thread died: also before `start` and after `close`."""
        return self._inbox.closed or self._thread.ident is None or self._thread.is_alive()

    @property
    def busy(self) -> bool:
        """Whether any goal runs or waits to run."""
        return self._executor.busy

    @property
    def moving(self) -> bool:
        """Whether a goal moves the robot, or waits to."""
        return self._executor.moving is not None

    @property
    def refusals(self) -> Mapping[str, int]:
        """Number of refused commands, by `Refusal`."""
        return self._inbox.refusals

    def close(self) -> None:
        """Stop everything and wait for the threads."""
        self._inbox.close()
        self.programs.close()
        self._executor.stop(because("shutting_down"), self._turn)
        self._executor.close()
        if self._thread.is_alive():
            self._thread.join()

    def submit(self, command: ConversationCommand, mark: int | None = None) -> None:
        """Take a command on the caller's thread: stop at once, or queue it for a turn.

        `mark` is the interlock's mark when the command was received, now by default. A command
        that was received before a stop is dropped; a stop never is.
        """
        mark = self._interlock.mark if mark is None else mark
        match command:
            case Interrupt(reason=reason, motion=motion, cause=cause):
                self._stopping.interrupt(reason, cause, motion=motion)
                self._release()
            case Reset():
                self._stopping.reset()
            case StopSpotted() | SpokenOn():
                self._stopping.heed(command)
            case SpokenOver():
                self._held = self._turn
                if self._speech_output:
                    self._speech_output.hold()
            case CancelProgram(program_id=program_id):
                self.programs.forget_by_id(program_id, because("called_off"))
            case Transcribing():
                self._question.spoken()
                self._states.transcribing()
            case TextInput() | Heard():
                self._take(command, mark)
            case RunSkill(name=name) if name == STOP and name in self._skills:
                self._stopping.call(lambda: self._begin_stop(command))
            case _:
                self._stopping.queue(command, mark)

    def _begin_stop(self, asked: RunSkill) -> None:
        call = Call(STOP, asked.arguments)
        self._executor.begin(call, self._skills, None, asked.way, self._interlock.mark)

    def stop(self, reason: Reason) -> None:
        """Stop everything at once and say nothing."""
        self._stopping.stop(reason)

    def is_stop(self, text: str) -> bool:
        """True if these words would stop the robot."""
        return self._stopping.is_stop(text)

    def set_language(self, code: str) -> None:
        """Use this language: at once for stop words, from the next sentence on for the rest."""
        self._stopping.set_language(code)
        self._inbox.put(inbox.SwitchLanguage(code))

    def set_confirm(self, confirm: Confirm) -> None:
        """Set when the robot asks before it drives, from the next sentence on."""
        self._asking.confirm = confirm

    def check_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> None:
        """Raise what `start_goal` would raise, without starting the goal.

        The bus carries a `GoalRejected` for a refusal; nothing else happens.
        """
        self._executor.check_begin(Call(name, arguments), self._skills, way, mark)

    def start_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        goal_id: str | None = None,
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> Goal:
        """Run one skill for a program, without a turn: the bus reports it, the robot is silent.

        A skill that moves pre-empts any other skill that moves, and stop words end it. A skill
        that moves nothing pre-empts nothing. `mark` is the interlock's mark when the request was
        received, now by default.

        Raises `InvalidValue` (`UnknownSkill` for the name) or `SkillFailed` (too many goals wait,
        a stop came after the request, the policy forbids it). The bus then carries a
        `GoalRejected`, and nothing else has happened.
        """
        mark = self._interlock.mark if mark is None else mark
        return self._executor.begin(Call(name, arguments), self._skills, goal_id, way, mark)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until no turn or goal runs or waits; False after the timeout."""
        deadline_s = None if timeout_s is None else self._clock.now() + timeout_s
        while True:
            left_s = None if deadline_s is None else max(0.0, deadline_s - self._clock.now())
            if not self._inbox.wait_idle(left_s):
                return False
            if not self._executor.busy and self._inbox.idle:
                return True
            if not self._executor.wait_idle(left_s):
                return False

    def _take(self, words: TextInput | Heard, mark: int) -> None:
        counts = isinstance(words, TextInput)
        if isinstance(words, Heard):
            mark = self._stopping.mark_of(words)
            try:
                goes_on = self._goes_on(words)
                counts = self._stopping.counts(words) and not goes_on
            finally:
                self._states.transcribed(words=counts)
        if counts and not self._stopping.hears(words):
            self._answer(
                words,
                lambda own: self._stopping.queue(own, mark),
                left=lambda: self._stopping.leave(words),
            )
        elif self._hearers and isinstance(words, Heard):
            self._hearers.withdraw(words)

    def _answer(
        self,
        words: TextInput | Heard,
        answer: Callable[[TextInput | Heard], None],
        left: Callable[[], None],
    ) -> None:
        """Call `answer`; or `left`, if the words were spoken and another robot answers them."""
        heard = words if isinstance(words, Heard) and words.way.spoken else None
        if self._hearers is None or heard is None:
            answer(words)
            return
        own = self._hearers.own_words(heard)

        def settle(other: str) -> None:
            if other:
                left()
                self._bus.publish(UtteranceLeft(other))
            else:
                answer(own)

        self._hearers.settle(heard, settle)

    def _goes_on(self, heard: Heard) -> bool:
        """Let an answer that was held for these words go on, or end it; True if it goes on."""
        if not heard.over:
            return False
        held, self._held = self._held, None
        asks = held is not None and held.outcome is Outcome.ASKED
        may_move = self._executor.busy or bool(self.programs.kept)
        stops = heard.spotted or (may_move and self.is_stop(heard.text))
        goes_on = not (asks or stops) and self._asking.replies.encourages(
            heard.text, heard.confidence, heard.rate
        )
        if not goes_on and held is self._turn:
            self._stopping.interrupt("spoken over", Cause.BARGE_IN, motion=False)
        elif heard.text and goes_on:
            self._bus.publish(Transcribed(clean(heard.text)))
        self._release()
        return goes_on

    def _release(self) -> None:
        if self._speech_output:
            self._speech_output.release()

    def _work(self) -> None:
        while not self._inbox.closed:
            with self._inbox.gate:  # a stop finds the item in the inbox or in its turn
                item = self._inbox.take(self._question.expires_in_s)
                if item is None and (due := self._question.due):
                    self._inbox.put(inbox.CountedDown(due.way), due.mark)
                    item = self._inbox.take()
                turn = self._new_turn(item) if item else None
                self._turn = turn if item and inbox.can_be_stopped(item) else None
                if isinstance(inbox.words_of(item), Heard):
                    self._stopping.last = turn
            self._question.expire()
            if item and turn:
                with bound(turn=turn.number):
                    try:
                        self._handle(item, turn, self._inbox.since_s)
                    finally:
                        self._end(turn, measured=inbox.asked_in_words(item))

    def _handle(self, item: inbox.Item, turn: Turn, put_s: float) -> None:
        """Carry out the item to its end; log an exception and apologise instead of raising it.

        `put_s` is the clock's time when the item was put into the inbox.
        """
        try:
            self._do(item, turn, put_s)
        except Exception:
            log.exception("turn_failed")
            if inbox.can_be_stopped(item):
                turn.say(self.interpreter.phrases.say("broken"), Outcome.FAILED)

    def _do(self, item: inbox.Item, turn: Turn, put_s: float) -> None:  # noqa: PLR0912 - one a kind
        match item:
            case TextInput():
                self._converse(Transcribed(clean(item.text), turn.number), turn, put_s)
            case Heard(text=said, confidence=sure):
                words = Transcribed(clean(said), turn.number, sure)
                self._converse(words, turn, item.ended_s)
            case Speak(text=text):
                turn.say(clean(text))
            case inbox.TooLong(length=length):
                if item.asked:
                    self._bus.publish(Transcribed(item.beginning, turn.number))
                book = self.interpreter.phrases
                told = book.say("too_long", length=length, limit=MAX_CHARACTERS)
                turn.say(told, Outcome.REFUSED)
            case RunSkill(name=name, arguments=arguments):
                self._executor.perform([Call(name, arguments)], self._skills, turn, "command")
            case inbox.Announce(text=text, detail=detail):
                turn.say(text, detail=detail)
            case inbox.Stopped():
                self._go_on(item, turn)
            case inbox.CountedDown():
                self._asking.counted_down(turn)
            case inbox.Forget():
                self.interpreter.forget()
                self._asking.forget()
            case inbox.SwitchLanguage(code=code):
                self.interpreter.set_language(code)
                self._asking.set_language()
            case inbox.Settle():
                pass  # ending this turn brings the state back to listening
            case _:
                assert_never(item)

    def _go_on(self, stopped: inbox.Stopped, turn: Turn) -> None:
        """Tell of the stop, and take up what else the words want."""
        self._states.enter(State.THINKING, turn)
        if stopped.told:
            turn.say(stopped.told)
        self._asking.after_stop(stopped, turn)
        if not turn.text and turn.outcome is not Outcome.ACTED:
            turn.say(self._stopping.in_words(STANDING))
        turn.settle()

    def _converse(self, words: Transcribed, turn: Turn, said_s: float) -> None:
        text = words.text
        self._bus.publish(words)
        if not text:
            turn.say(self.interpreter.phrases.say("not_heard"), Outcome.NOT_UNDERSTOOD)
        else:
            self._states.enter(State.THINKING, turn)
            meaning = self._asking.attend(text, turn, said_s)
            turn.settle()
            self.interpreter.remember(text, turn, meaning)

    def _new_turn(self, taken: inbox.Item) -> Turn:
        item = inbox.words_of(taken) or taken
        turn = Turn(
            next(self._numbers),
            self._bus,
            self._clock,
            on_speech=lambda: self._states.enter(State.SPEAKING, turn),
            speech_output=self._speech_output,
            asked=InputTiming(item.ended_s, item.stt_s) if isinstance(item, Heard) else None,
            way=inbox.way_of(item),
            mark=self._inbox.mark,
            plainly=isinstance(item, Heard) and item.spotted,
            doubted=isinstance(item, Heard) and self._stopping.doubts(item),
            hearing=item.confidence if isinstance(item, Heard) else 1.0,
            others=item.others if isinstance(item, Heard) else (),
            rate=item.rate if isinstance(item, Heard) else None,
        )
        return turn

    def _end(self, turn: Turn, *, measured: bool) -> None:
        turn.finish(measured=measured)
        self._question.said(turn)
        with self._inbox.gate:
            if turn is self._stopping.last and not turn.token.cancelled:
                self.follow_ups.open(asked=turn.outcome is Outcome.ASKED)
            self._turn = None
        self._states.rest()
        self._bus.publish(TurnEnded(turn.number, turn.outcome if measured else None, turn.tokens))
        self._inbox.done()
