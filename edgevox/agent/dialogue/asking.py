"""The step from a meaning to its execution, with a question before it if needed.

`Performer` runs the calls of a meaning now, or keeps its program. `Asking` decides whether to ask
first: by the confidence of the meaning, the setting `confirm`, and the demands of the policy and
the skills. It reads an answer or a correction ("no, the bedroom") before any other understanding.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from edgevox.agent.agents import Agent
from edgevox.agent.dialogue.acts import Answer, Answers, correct, denies
from edgevox.agent.dialogue.memory import DriveCall, LastDrive
from edgevox.agent.dialogue.question import OpenQuestion, Question
from edgevox.agent.dialogue.skills import OTHER, DialogueSkills
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.disfluencies import is_back_channel
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.nlu.templates import RefusedCommand
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.policy import NeedsConfirmation
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.questions import ProgramQuestions
from edgevox.agent.skills import STOP, Call, Skill
from edgevox.agent.stop.words import find_stop_word
from edgevox.agent.text.words import continued
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import ConfirmationStatus
from edgevox.core.events import Outcome
from edgevox.core.languages import LANGUAGES, STOP_WORDS
from edgevox.core.settings import Confirm


@dataclass(frozen=True, slots=True)
class Prepared:
    """A meaning that was checked and may be done."""

    meaning: Meaning
    """The meaning."""
    goals: Sequence[Goal]
    """The goals of its calls; empty for a program."""
    confirmed: bool
    """True if a person said yes to it."""


class Performer:
    """Checks and performs meanings, on the conversation's thread.

    `last` is the drive that a correction changes.
    """

    def __init__(
        self,
        interpreter: Interpreter,
        executor: SkillExecutor,
        programs: Programs,
        dialogue_skills: DialogueSkills,
        last: LastDrive,
    ) -> None:
        self.last = last
        self._interpreter = interpreter
        self._executor = executor
        self._programs = programs
        self._dialogue_skills = dialogue_skills
        self._questions = ProgramQuestions(
            programs,
            phrases=lambda: interpreter.phrases,
            is_plain=lambda text: isinstance(interpreter.plain(text), Meaning),
        )

    def prepare(self, meaning: Meaning, turn: Turn, *, confirmed: bool = False) -> Prepared | None:
        """Check a meaning; if it is wrong or forbidden, say so and return None.

        Raises `NeedsConfirmation` if the policy wants a yes and the meaning is not `confirmed`.
        """
        if meaning.program:
            kept = self._programs.may_keep(meaning.program, turn, confirmed=confirmed)
            return Prepared(meaning, (), confirmed) if kept else None
        skills = meaning.agent.every_skill
        goals = self._executor.prepare(meaning.calls, skills, turn, confirmed=confirmed)
        if not goals:
            return None
        calls = tuple(Call(goal.skill.name, goal.arguments) for goal in goals)
        asked = Meaning(meaning.agent, calls, meaning.source, meaning.confidence)
        return Prepared(asked, goals, confirmed)

    def answer(self, text: str, turn: Turn) -> bool:
        """Answer a question about the kept programs; False if the text is none."""
        return self._questions.answer(text, turn)

    @property
    def moving(self) -> bool:
        """True while a goal moves the robot, or waits to."""
        return self._executor.moving is not None

    def drives(self, prepared: Prepared) -> bool:
        """True if it sets the body in motion, now or later."""
        program = prepared.meaning.program
        return self._programs.drives(program) if program else bool(_driving(prepared))

    def lasts(self, prepared: Prepared) -> bool:
        """True if it changes something for good, for example forgets a place."""
        skills = prepared.meaning.agent.every_skill
        return any(skills[call.skill].lasting for call in prepared.meaning.every_call)

    def question(self, prepared: Prepared) -> str:
        """The question whether to do it."""
        phrases, program = self._interpreter.phrases, prepared.meaning.program
        if program:
            return phrases.say("do_this", told=self._programs.in_words(program))
        asked = [one for one in prepared.goals if _is_asked_about(one.skill)] or prepared.goals
        return phrases.question([(goal.skill, goal.arguments) for goal in asked])

    def perform(self, prepared: Prepared, turn: Turn) -> None:
        """Do it, or say why not."""
        if prepared.meaning.program:
            self._keep(prepared, turn)
        else:
            self._run(prepared, turn)

    def _keep(self, prepared: Prepared, turn: Turn) -> None:
        program = prepared.meaning.program
        if program and self._programs.keep(program, turn, confirmed=prepared.confirmed):
            self.last.forget()
            self._dialogue_skills.kept(turn.number, program)

    def _run(self, prepared: Prepared, turn: Turn) -> None:
        driving = _driving(prepared)
        if len(driving) == 1:
            call = Call(driving[0].skill.name, driving[0].arguments)
            self.last.begin(DriveCall(prepared.meaning.agent, call, turn.number))
        elif driving:
            self.last.forget()  # a correction would not tell which of several it means
        if not self._executor.run(prepared.goals, turn, prepared.meaning.source):
            self.last.forget()


def _driving(prepared: Prepared) -> Sequence[Goal]:
    return [goal for goal in prepared.goals if goal.skill.drives]


def _is_asked_about(one: Skill) -> bool:
    """True if a question must name the skill; skills that only tell something are left out."""
    return one.drives or one.lasting or one.confirm


_First = tuple[Agent, Sequence[Call], Call]
"""What a correction changes: an agent, its calls, and the one of them that drives."""

WHETHER_IN, WHERE = "are_you_in", "get_pose"
"""The question whether the robot is in a place, and the one that is asked with two places."""

YES_FROM = 0.6
"""Recognition confidence below which the robot asks again after a spoken yes, so that no guessed
yes moves it. Of 58 yeses by the tuning voices, in quiet and in noise, 55 were surer."""


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
        self._answers = _answers(interpreter.phrases)

    def set_language(self) -> None:
        """Read answers in the interpreter's language from now on."""
        self._answers = _answers(self._interpreter.phrases)

    def forget(self) -> None:
        """Forget the last drive, so that nothing is left to correct."""
        self._last.forget()

    def follows(self, text: str) -> bool:
        """True if these words answer the robot, correct it or are a plain command. Any thread."""
        answer = self._answers.read(text)
        if answer is Answer.YES and self.question.asked:
            return True
        if answer is Answer.NO and (self.question.asked or self._performer.moving):
            return True
        if self._correction(text) or (self._performer.moving and self._denies_drive(text)):
            return True
        plain = self._interpreter.plain(text)
        return isinstance(plain, Meaning) and plain.sure

    def encourages(self, text: str) -> bool:
        """True if words over the robot's speech want it to go on: "mm-hm", laughter. Any thread."""
        if self.question.asked:
            return False
        said_yes = self._answers.read(text) is Answer.YES
        return said_yes or is_back_channel(text, self._interpreter.phrases.code)

    def attend(self, text: str, turn: Turn, said_s: float) -> Meaning | None:
        """Do what these words ask for, or ask first; return what was done, or None.

        `said_s` is the time when the words ended: words from before a question do not answer it.
        """
        self.question.expire()
        if choice := self._chosen(text):
            return self._carried_out(choice, turn, said_s)
        answer = self._answers.read(text)
        denied = self._denied(text, answer)
        if denied is None and answer and self._counts(answer, text):
            return self._answered(answer, turn, said_s)
        meaning = self._corrected(text)
        if meaning is None and denied is not None:
            return self._stopped_for(denied, turn)
        between = None if meaning else self._asked_between(text)
        if meaning is None:
            rest = text if between else self._unanswered(text)
            taken_back = bool(rest) and self._taken_back(rest)
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
        if meaning is None or turn.token.cancelled:
            return meaning
        turn.decided(meaning.every_call, meaning.source, meaning.measured)
        meaning = self._interpreter.as_heard(meaning, text, turn)
        done = self.act(meaning, turn)
        if between and self.question.asked is between:
            self._ask_again(turn)
        return meaning if done else None

    def act(self, meaning: Meaning, turn: Turn) -> bool:
        """Do what is meant, or ask first; always ask if the policy wants a yes.

        Returns False if the robot asked, or wants plainer words.
        """
        try:
            prepared = self._performer.prepare(meaning, turn)
        except NeedsConfirmation:
            if prepared := self._performer.prepare(meaning, turn, confirmed=True):
                self._ask(prepared, turn)
            return False
        if prepared is None:
            return True
        plain = meaning.sure and (meaning.source == "template" or not turn.plainly)
        unsure = turn.doubted or not plain
        asks = self.confirm == "always" or (unsure and self.confirm == "unsure")
        drives = self._performer.drives(prepared)
        lasts = unsure and self._performer.lasts(prepared)
        if not (drives or lasts) or not (asks or unsure):
            self._performer.perform(prepared, turn)
            return True
        if asks:
            self._ask(prepared, turn)
        else:
            turn.say(self._interpreter.phrases.say("say_plainly"), Outcome.REFUSED)
        return False

    def _ask(self, prepared: Prepared, turn: Turn) -> None:
        text = self._performer.question(prepared)
        self._put(Question(prepared.meaning, text, turn.number), turn)

    def _ask_again(self, turn: Turn) -> None:
        """Ask the same question again: the yes was hardly heard, or a question came between."""
        if asked := self.question.asked:
            self._dialogue_skills.confirmed(turn.number, asked.turn)
            self._put(replace(asked, turn=turn.number), turn)

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

    def _chosen(self, text: str) -> Meaning | None:
        """The one of several meanings that an answer to the open question chooses, or None."""
        asked = self.question.asked
        if asked is None or not asked.others:
            return None
        chosen = self._answers.chosen(text, asked.sentences)
        return None if chosen is None else (asked.meaning, *asked.others)[chosen]

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

    def go_on(self, text: str, before: str, turn: Turn) -> Meaning | None:
        """Take up what a person wants in place of what was stopped, or of the words `before`.

        The robot asks before it moves. Words that mean nothing to it are left alone.
        """
        turn.doubted = True
        for ordered, rest, _ in self._answers.taken_back(before):
            before = before if rest else ordered  # "go to the kitchen, no"
        plain = self._interpreter.plain(before) if before else None
        first = self._one_drive(plain) if isinstance(plain, Meaning) else self._last_drive()
        meant = self._changed(text, first) if first else None
        read = meant or self._interpreter.plain(self._answers.after_denial(text) or text)
        if isinstance(read, RefusedCommand):
            turn.say(read.reason, Outcome.REFUSED, detail=read.detail)
        if not isinstance(read, Meaning):
            return None
        meaning = self._dialogue_skills.meant(read, turn)
        return meaning if meaning and self.act(meaning, turn) else None

    def _taken_back(self, text: str) -> Meaning | bool:
        """What a sentence means that takes back its own beginning: "the kitchen, no, the office".

        True if only the beginning can be meant, which nothing is left of; False for any other text.
        """
        if self._is_plain(text):
            return False
        for before, after, is_no in self._answers.taken_back(text):
            plain = self._interpreter.plain(before)
            meant = plain if isinstance(plain, Meaning) else self._taken_back(before)
            first = self._one_drive(meant) if isinstance(meant, Meaning) else None
            if first is None:
                continue
            right = self._changed(after, first) or self._interpreter.plain(after)
            if isinstance(right, Meaning):
                return right
            if is_no:
                return True
        return False

    def _one_drive(self, meaning: Meaning) -> _First | None:
        """What could be corrected in a meaning; None if not just one of its calls drives."""
        skills = meaning.agent.every_skill
        driving = [call for call in meaning.calls if skills[call.skill].drives]
        return (meaning.agent, meaning.calls, driving[0]) if len(driving) == 1 else None

    def _changed(self, text: str, first: _First, *, taken_back: bool = True) -> Meaning | None:
        """The calls with another one in place of the drive that the text corrects.

        With `taken_back`, words before the text took it back.
        """
        agent, calls, wrong = first
        skill, book = agent.every_skill[wrong.skill], self._interpreter.phrases
        right = correct(wrong, skill, text, self._answers, book, taken_back=taken_back)
        rest = text if taken_back else self._answers.after_no(text)
        right = right or (self._other_way(wrong, agent, rest) if rest else None)
        if right is None:
            return None
        return Meaning(agent, tuple(right if c is wrong else c for c in calls), "template")

    def _corrected(self, text: str) -> Meaning | None:
        """The correction of the open question, which it ends, or of the last drive, or None."""
        right = self._correction(text)
        if right:
            self.question.end(ConfirmationStatus.DECLINED)
        return right

    def _correction(self, text: str) -> Meaning | None:
        asked = self.question.asked
        first = self._one_drive(asked.meaning) if asked else self._last_drive()
        return self._changed(text, first, taken_back=False) if first else None

    def _last_drive(self) -> _First | None:
        drive = self._last.corrigible
        return (drive.agent, (drive.call,), drive.call) if drive else None

    def _other_way(self, wrong: Call, agent: Agent, text: str) -> Call | None:
        """The call by the same amount the other way: "no, to the right"."""
        plain = self._interpreter.plain(text)
        if not isinstance(plain, Meaning) or len(plain.calls) != 1:
            return None
        (call,) = plain.calls
        skills = agent.every_skill
        if call.skill == wrong.skill or call.arguments or call.skill not in skills:
            return None
        one, other = skills[call.skill], skills[wrong.skill]
        same = one.arguments_model.model_fields.keys() == other.arguments_model.model_fields.keys()
        return (
            Call(call.skill, wrong.arguments) if one.relative and other.relative and same else None
        )

    def _asked_between(self, text: str) -> Question | None:
        """The open question that these words leave open: they only ask the robot something."""
        plain = self._interpreter.plain(text) if self.question.asked else None
        asks = isinstance(plain, Meaning) and self._dialogue_skills.only_tells(plain.calls)
        return self.question.asked if asks else None

    def _denied(self, text: str, answer: Answer | None) -> str | None:
        """What is left of words that say no to the motion: "no", "no, go east"; None for others.

        None while a question waits for that no, where a plain command follows, and for "don't
        stop". "The other one" says no as well.
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
            return "" if self._denies_drive(text) else None
        code = self._interpreter.phrases.code
        if self._is_plain(text) or (not rest and _denies_a_stop(text, code)):
            return None
        return None if self._asks_for_more(rest) else rest

    def _stopped_for(self, rest: str, turn: Turn) -> Meaning:
        """Stop for words that say no to the motion, and take up what they want instead."""
        agent = self._interpreter.active
        stop = Meaning(agent, (Call(STOP),), "template")
        turn.decided(stop.calls, stop.source, stop.measured)
        self.act(stop, turn)
        return (self.go_on(rest, "", turn) if rest else None) or stop

    def _denies_drive(self, text: str) -> bool:
        """True for "not to the kitchen", on the way there."""
        if drive := self._last.corrigible:
            skill = drive.agent.every_skill[drive.call.skill]
            return denies(drive.call, skill, text, self._answers, self._interpreter.phrases)
        return False

    def _means_another(self, text: str) -> bool:
        plain = self._interpreter.plain(text)
        return isinstance(plain, Meaning) and any(call.skill == OTHER for call in plain.calls)

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


def _denies_a_stop(text: str, code: str) -> bool:
    """True for "don't stop": what is denied is a stop word."""
    words = text.split() if LANGUAGES[code].spaced else list(text)
    space = " " if LANGUAGES[code].spaced else ""
    return any(find_stop_word(code, space.join(words[at:])) for at in range(1, len(words)))


def _names_anything(meaning: Meaning) -> bool:
    """True if a call takes words that name nothing known, and perhaps words of both choices."""
    return any(meaning.agent.every_skill[call.skill].new_names for call in meaning.calls)


def _answers(book: Phrasebook) -> Answers:
    books = (book, book.fallback) if book.fallback else (book,)
    hesitant = [word for one in books for word in STOP_WORDS[one.code].hesitant]
    return Answers([one.answers for one in books], spaced=book.hearing.spaced, hesitant=hesitant)
