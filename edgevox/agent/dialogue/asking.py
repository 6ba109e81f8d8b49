"""The step from words to what is done, with a question or a countdown before it if needed.

`Asking` decides whether to ask first: by the confidence of the meaning, the setting `confirm`, and
the demands of the policy and the skills. It reads an answer or a correction ("no, the bedroom")
before any other understanding.
"""

from collections.abc import Sequence
from dataclasses import replace

from edgevox.agent.dialogue.acts import Answer, Answers
from edgevox.agent.dialogue.corrections import Corrections, Instead
from edgevox.agent.dialogue.performer import Performer, Prepared
from edgevox.agent.dialogue.question import OpenQuestion, Question
from edgevox.agent.dialogue.replies import YES_FROM, Replies
from edgevox.agent.dialogue.skills import DOING, DialogueSkills
from edgevox.agent.inbox import Stopped
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM, THE_OTHER, Meaning
from edgevox.agent.nlu.templates import RefusedCommand
from edgevox.agent.policy import NeedsConfirmation, Rule
from edgevox.agent.skills import STOP, Call
from edgevox.agent.stop.words import denies_stop
from edgevox.agent.text.words import continued
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import ConfirmationStatus
from edgevox.core.events import Outcome
from edgevox.core.settings import Confirm

WHETHER_IN, WHERE = "are_you_in", "get_pose"
"""The question whether the robot is in a place, and the one that is asked with two places."""

_FAIRLY_SURE_FROM = {"template": SURE_FROM, "reading": (ASK_FROM + SURE_FROM) / 2 + 0.01}
"""Confidences by source from which on a countdown may stand in for a question: that of readings is
above those of all doubtful ones."""


class Asking:
    """Does what words mean, or asks first. Used from the conversation's thread.

    `question` is shared with `Stopping`; `confirm` may be set from any thread. A question is asked
    only before a drive, and before a lasting change that was not plainly said. A skill that tells
    something runs at once, and so does a stop. A program gets its question before it is kept, as
    its calls would.
    """

    def __init__(
        self,
        interpreter: Interpreter,
        performer: Performer,
        dialogue_skills: DialogueSkills,
        question: OpenQuestion,
        *,
        confirm: Confirm = "unsure",
    ) -> None:
        self.confirm = confirm
        self.question = question
        self._interpreter = interpreter
        self._performer = performer
        self._dialogue_skills = dialogue_skills
        self._last = performer.last
        self._corrections = Corrections(interpreter, question, performer.last)
        self.replies = Replies(interpreter, performer, question, self._corrections)

    def set_language(self) -> None:
        """Read answers in the interpreter's language from now on."""
        self._corrections.set_language()

    @property
    def _answers(self) -> Answers:
        return self._corrections.answers

    def forget(self) -> None:
        """Forget the last drive, so that nothing is left to correct."""
        self._last.forget()

    def attend(self, text: str, turn: Turn, said_s: float) -> Meaning | None:
        """Do what these words ask for, or ask first; return what was done, or None.

        `said_s` is the time when the words ended: words from before a question do not answer it.
        """
        self.question.expire()
        if misheard := self.replies.misheard(text, turn.others):
            text, turn.hearing = misheard.text, misheard.confidence
        if choice := self.replies.chosen(text):
            return self._carried_out(choice, turn, said_s)
        counting = self.question.asked if self.question.counts_down else None
        if counting and self.replies.urges(text):
            return self._carried_out(counting.meaning, turn, said_s)
        return self._attend(text, turn, said_s)

    def _attend(self, text: str, turn: Turn, said_s: float) -> Meaning | None:
        """The same, for words that choose nothing and urge to nothing."""
        if denies_stop(self._interpreter.phrases.code, text):
            return self._tell_doing(turn)
        answer = self._answers.read(text)
        if answer is None and self.question.asked and self._corrections.denies(text):
            answer = Answer.NO
        denied = self._denied(text, answer)
        if denied is None and answer and self._counts(answer, text):
            return self._answered(answer, turn, said_s)
        right = self._corrections.of(text) or self._corrections.bare(text)
        instead = None if right else self._corrections.instead(text)
        if instead and (right := self._wanted(instead)) is None:
            if instead.keeps:
                return self._kept(turn, said_s)
            if self._performer.moving:
                return self._stopped_for(instead.rest, turn)
            if isinstance(instead.meaning, RefusedCommand):
                self._refuse(instead.meaning, turn)
                return None
        if right:
            self.question.end(ConfirmationStatus.DECLINED)
            right = self._dialogue_skills.meant(right, turn)
            return self._do(right, turn, text, takes_back=True) if right else None
        if denied is not None:
            return self._stopped_for(denied, turn)
        if between := self._asked_between(text):
            return self._between(text, between, turn)
        if self._performer.moving and self._interpreter.denies_motion(text):
            return self._stopped_for("", turn)
        return self._take_up(text, turn, bare=instead is not None)

    def _wanted(self, instead: Instead) -> Meaning | None:
        """The plain command in place of what is taken back, unless a stop must come first."""
        meaning = instead.meaning
        if not isinstance(meaning, Meaning):
            return None
        tells = self._dialogue_skills.only_tells(meaning.calls)
        return None if tells and instead.ends and self._performer.moving else meaning

    def _kept(self, turn: Turn, said_s: float) -> Meaning | None:
        """Words want just what was asked about, or what the robot is doing."""
        if asked := self.question.asked:
            return self._carried_out(asked.meaning, turn, said_s)
        return self._tell_doing(turn)

    def _refuse(self, refused: RefusedCommand, turn: Turn) -> None:
        self.question.end(ConfirmationStatus.DECLINED)
        turn.say(refused.reason, Outcome.REFUSED, detail=refused.detail)

    def _tell_doing(self, turn: Turn) -> Meaning | None:
        """Say what the robot is doing, for words that want it to go on."""
        doing = Meaning(self._interpreter.active, (Call(DOING),), "template")
        done = self._do(doing, turn)
        if self.question.asked:
            self._ask_again(turn)
        return done

    def _between(self, text: str, question: Question, turn: Turn) -> Meaning | None:
        """Answer what is asked while a question waits, and ask that again."""
        meaning = self._dialogue_skills.meant(self._interpreter.understand(text, turn), turn)
        done = self._do(meaning, turn, text)
        if self.question.asked is question:
            self._ask_again(turn)
        return done

    def _take_up(self, text: str, turn: Turn, *, bare: bool) -> Meaning | None:
        """Understand words that answer and correct nothing.

        `bare`: they name what is wanted beside what is not, but no act. Then the robot asks.
        """
        counted = self.question.counts_down
        rest = self._unanswered(text)
        taken_back = bool(rest) and self._corrections.taken_back(rest)
        if taken_back is True and self._performer.moving:
            return self._stopped_for("", turn)
        if not rest or taken_back is True:
            turn.say(self._interpreter.phrases.say("left_undone"))
            return None
        if self._performer.answer(rest, turn):
            return None
        if not taken_back and (either := self._either(rest)):
            return self._do_either(*either, turn)
        meaning = taken_back or self._interpreter.understand(rest, turn)
        meaning = self._dialogue_skills.meant(meaning, turn)
        if meaning and bare and not taken_back:
            meaning = replace(meaning, confidence=min(meaning.confidence, ASK_FROM))
        done = self._do(meaning, turn, rest)
        if counted and turn.outcome not in (Outcome.ACTED, Outcome.ASKED):
            turn.say(self._interpreter.phrases.say("left_undone"))
        return done

    def _do(
        self, meaning: Meaning | None, turn: Turn, text: str = "", *, takes_back: bool = False
    ) -> Meaning | None:
        """Do what is meant, or ask first; return it if it was done."""
        if meaning is None or turn.token.cancelled:
            return meaning
        turn.decided(meaning.every_call, meaning.source, meaning.confidence)
        meaning = self._interpreter.as_heard(meaning, text, turn)
        return meaning if self.act(meaning, turn, text, takes_back=takes_back) else None

    def act(
        self, meaning: Meaning, turn: Turn, text: str = "", *, takes_back: bool = False
    ) -> bool:
        """Do what is meant, or ask first; always ask if the policy wants a yes.

        `text` are the words that mean it, if only they do: without them there is no countdown.
        `takes_back`: the words want it in place of the motion that goes on. That then ends, whether
        or not this can be done at once. Returns False if the robot asked, or wants plainer words.
        """
        try:
            prepared = self._performer.prepare(meaning, turn)
        except NeedsConfirmation as needed:
            counts = needed.rule is Rule.COUNTDOWN
            tells = counts and self._dialogue_skills.only_tells(meaning.calls)
            if takes_back and not tells:
                self._halt(turn)
            prepared = self._performer.prepare(meaning, turn, confirmed=True)
            if prepared and tells:  # nothing that a person could want to end
                self._performer.perform(prepared, turn)
            elif prepared:
                goes = counts and self._may_count_down(prepared, text, turn)
                self._ask(prepared, turn, goes=goes)
            return tells
        plain = meaning.sure and (meaning.source == "template" or not turn.plainly)
        unsure = turn.doubted or not plain
        asks = self.confirm == "always" or (unsure and self.confirm == "unsure")
        drives = prepared is not None and self._performer.drives(prepared)
        lasts = prepared is not None and unsure and self._performer.lasts(prepared)
        at_once = prepared is not None and (not (drives or lasts) or not (asks or unsure))
        if takes_back and not at_once:
            self._halt(turn)
        if prepared is None:
            return True
        if at_once:
            self._performer.perform(prepared, turn)
        elif asks:
            self._ask(prepared, turn)
        else:
            turn.say(self._interpreter.phrases.say("say_plainly"), Outcome.REFUSED)
        return at_once

    def _halt(self, turn: Turn) -> Meaning | None:
        """Stop what moves the robot, for words that take it back; None if nothing does."""
        agent = self._interpreter.active
        if not self._performer.moving or STOP not in agent.every_skill:
            return None
        stop = Meaning(agent, (Call(STOP),), "template")
        turn.decided(stop.calls, stop.source, stop.confidence)
        self.act(stop, turn)
        return stop

    def _may_count_down(self, prepared: Prepared, text: str, turn: Turn) -> bool:
        """True if the words are sure enough, and what they want can be undone, to do it unasked.

        Words that a reading rests on may hold no number and no denial: it may have missed them.
        """
        meaning = prepared.meaning
        skills = meaning.agent.every_skill
        undoable = all(
            skills[one.skill].undoable
            for one in meaning.calls
            if not self._dialogue_skills.only_tells([one])
        )
        if meaning.program or not text or not undoable or turn.doubted or turn.plainly:
            return False
        if self.confirm == "always":
            return False
        if meaning.source == "reading" and self._interpreter.is_held_back(text):
            return False
        return meaning.confidence >= _FAIRLY_SURE_FROM[meaning.source]

    def _ask(self, prepared: Prepared, turn: Turn, *, goes: bool = False) -> None:
        """Ask whether to do it; or if it `goes`, say so and count down."""
        text = self._performer.question(prepared, goes=goes)
        meaning, way, mark = prepared.meaning, turn.way, turn.mark
        self._put(Question(meaning, text, turn.number, goes=goes, way=way, mark=mark), turn)

    def counted_down(self, turn: Turn) -> None:
        """Do what was counted down to; ask instead if somebody spoke whose words never came."""
        due = self.question.take_due()
        if due is None:  # a stop, a no or a new order has ended it meanwhile
            return
        question, spoken = due
        self._dialogue_skills.confirmed(turn.number, question.turn)
        if prepared := self._performer.prepare(question.meaning, turn, confirmed=True):
            if spoken:
                self._ask(prepared, turn)
            else:
                self._performer.perform(prepared, turn)

    def _ask_again(self, turn: Turn) -> None:
        """Ask the same question again: the yes was hardly heard, or a question came between."""
        asked = self.question.asked
        if asked is None:
            return
        self._dialogue_skills.confirmed(turn.number, asked.turn)
        if not asked.goes:
            self._put(replace(asked, turn=turn.number), turn)
        elif prepared := self._performer.prepare(asked.meaning, turn, confirmed=True):
            self._ask(prepared, turn)

    def _put(self, question: Question, turn: Turn) -> None:
        if self.question.ask(question):
            turn.say(question.text, Outcome.ASKED)

    def _counts(self, answer: Answer, text: str) -> bool:
        """True if the words are an answer: a question waits, or they are no plain command.

        "Go ahead" is both a yes and a command to a walking robot.
        """
        waits = self.question.awaits if answer is Answer.YES else bool(self.question.asked)
        return waits or not self._is_plain(text)

    def _is_plain(self, text: str) -> bool:
        return isinstance(self._interpreter.plain(text), Meaning)

    def _answered(self, answer: Answer, turn: Turn, said_s: float) -> Meaning | None:
        """Act on an answer; return the meaning that a yes carries out, or None."""
        if answer is Answer.NO:
            asked = self.question.end(ConfirmationStatus.DECLINED)
            turn.say(self._interpreter.phrases.say("left_undone" if asked else "what_instead"))
            return None
        asked = self.question.asked
        meant = asked.meaning if asked and not asked.others else None
        return self._carried_out(meant, turn, said_s)

    def _carried_out(self, meaning: Meaning | None, turn: Turn, said_s: float) -> Meaning | None:
        """Do what an answer chose, if it was plainly heard in time; else ask again."""
        if not self.question.is_answered_at(said_s):
            turn.say(self._interpreter.phrases.say("nothing_asked"))
            return None
        if turn.hearing < YES_FROM or meaning is None:
            self._ask_again(turn)
            return None
        question = self.question.end(ConfirmationStatus.CONFIRMED)
        if question is None:  # a stop has cancelled it meanwhile
            return None
        self._dialogue_skills.confirmed(turn.number, question.turn)
        if prepared := self._performer.prepare(meaning, turn, confirmed=True):
            self._performer.perform(prepared, turn)
        return meaning

    def _either(self, text: str) -> tuple[Sequence[str], Sequence[Meaning]] | None:
        """The orders or questions that a sentence with an "or" leaves open, or None."""
        if self._is_plain(text):
            return None
        for sentences in self._answers.alternatives(text):
            read = [self._interpreter.plain(one) for one in sentences]
            meanings = [one for one in read if isinstance(one, Meaning)]
            if len(meanings) == len(read) and all(
                one.agent is meanings[0].agent and one.sure and not _names_anything(one)
                for one in meanings
            ):
                return sentences, meanings
        return None

    def _do_either(
        self, sentences: Sequence[str], meanings: Sequence[Meaning], turn: Turn
    ) -> Meaning | None:
        """Ask which of several orders to do; questions are all answered."""
        every = replace(meanings[0], calls=tuple(call for one in meanings for call in one.calls))
        if self._dialogue_skills.only_tells(every.calls):
            if {one.skill for one in every.calls} == {WHETHER_IN}:
                every = replace(every, calls=(Call(WHERE),))
            return every if self.act(every, turn) else None
        prepared = [self._performer.prepare(one, turn, confirmed=True) for one in meanings]
        asked = [one for one in prepared if one]
        if len(asked) == len(prepared):
            say = self._interpreter.phrases.say
            text, *others = map(self._performer.question, asked)
            for other in others:
                text = say("either", first=text, second=continued(other))
            meant, *instead = (one.meaning for one in asked)
            self._put(Question(meant, text, turn.number, tuple(instead), tuple(sentences)), turn)
        return None

    def after_stop(self, stopped: Stopped, turn: Turn) -> Meaning | None:
        """Take up what else a person wants who stopped the robot; it asks before it moves.

        Words that mean nothing to it are left alone.
        """
        read: Meaning | RefusedCommand | None = None
        if stopped.opened:
            read = self._interpreter.opened_by_wait(stopped.opened)
        if read is None and stopped.after:
            read = self._corrections.after_stop(stopped.after, stopped.before)
        if read is None and stopped.stood:
            read = self._interpreter.joined_to_stop(stopped.stood)
        return self._taken_up(read, turn)

    def go_on(self, text: str, before: str, turn: Turn) -> Meaning | None:
        """Take up what a person wants in place of what was stopped, or of the words `before`."""
        return self._taken_up(self._corrections.after_stop(text, before), turn)

    def _taken_up(self, read: Meaning | RefusedCommand | None, turn: Turn) -> Meaning | None:
        turn.doubted = True
        if isinstance(read, RefusedCommand):
            turn.say(read.reason, Outcome.REFUSED, detail=read.detail)
        if not isinstance(read, Meaning):
            return None
        meaning = self._dialogue_skills.meant(read, turn)
        return meaning if meaning and self.act(meaning, turn) else None

    def _asked_between(self, text: str) -> Question | None:
        """The open question that these words leave open: they only ask the robot something."""
        if not self.question.asked or self.question.counts_down:
            return None
        plain = self._interpreter.plain(text)
        asks = isinstance(plain, Meaning) and self._dialogue_skills.only_tells(plain.calls)
        return self.question.asked if asks else None

    def _denied(self, text: str, answer: Answer | None) -> str | None:
        """What is left of words that say no to the motion: "no", "no, go east"; None for others.

        None while a question waits for that no, and where a plain command follows. "The other one"
        says no as well.
        """
        agent = self._interpreter.active
        if self.question.asked or not self._performer.moving or STOP not in agent.every_skill:
            return None
        if answer is Answer.NO and self._counts(answer, text):
            return ""
        rest = self._answers.after_denial(text)
        if rest is None:
            if self._means_another(text):
                return text
            return "" if self._corrections.denies(text) else None
        if self._corrections.denies(text):
            return ""
        if self._is_plain(text) or denies_stop(self._interpreter.phrases.code, text, begins=True):
            return None
        return None if self._asks_for_more(rest) else rest

    def _stopped_for(self, rest: str, turn: Turn) -> Meaning | None:
        """Stop for words that say no to the motion, and take up what they want instead."""
        stop = self._halt(turn)
        return (self.go_on(rest, "", turn) if rest else None) or stop

    def _means_another(self, text: str) -> bool:
        plain = self._interpreter.plain(text)
        return isinstance(plain, Meaning) and any(call.skill == THE_OTHER for call in plain.calls)

    def _asks_for_more(self, text: str) -> bool:
        """True if the text is a plain command, and no mere question, nor for "the other one"."""
        plain = self._interpreter.plain(text)
        if not isinstance(plain, Meaning) or self._means_another(text):
            return False
        return plain.sure and not self._dialogue_skills.only_tells(plain.calls)

    def _unanswered(self, text: str) -> str:
        """The words left to understand: all, or those after the no of "no, go to the office".

        Empty if the question is declined by a no whose following words are no plain command: the
        robot does not guess then.
        """
        asked = self.question.asked
        corrects = asked or self._last.corrigible
        rest = (self._answers.after_denial(text) or "") if corrects else ""
        plain = bool(rest) and self._interpreter.plain(rest) is not None
        if plain or (rest and asked):
            self.question.end(ConfirmationStatus.DECLINED)
            return rest if plain else ""
        self.question.end(ConfirmationStatus.REPLACED)
        return text


def _names_anything(meaning: Meaning) -> bool:
    """True if a call takes words that name nothing known, and perhaps words of both choices."""
    return any(meaning.agent.every_skill[call.skill].new_names for call in meaning.calls)
