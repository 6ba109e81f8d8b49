"""Does what words mean, or asks back first, and understands what is answered.

What is neither sure nor refused is asked about. Which it is follows from how sure the meaning is,
from the setting `confirm`, and from whether somebody demands it. The answer, or a correction ("no,
the bedroom"), is understood before anything else is thought about.

Does what words mean: runs the calls of a meaning now, or keeps its program.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from edgevox.agent.dialogue.acts import Answer, Answers, correct
from edgevox.agent.dialogue.memory import DriveCall, LastDrive
from edgevox.agent.dialogue.question import OpenQuestion, Question
from edgevox.agent.dialogue.skills import DialogueSkills
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.policy import NeedsConfirmation
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.questions import ProgramQuestions
from edgevox.agent.skills import Call, Skill
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import ConfirmationStatus
from edgevox.core.events import Outcome
from edgevox.core.settings import Confirm


@dataclass(frozen=True, slots=True)
class Prepared:
    """A meaning that was checked and may be done, with the goals of its calls.

    `confirmed`: somebody has said yes to it.
    """

    meaning: Meaning
    goals: Sequence[Goal]
    confirmed: bool


class Performer:
    """Used from the conversation's thread. `last` is the drive that may be corrected."""

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
        """What may be done; None if it is wrong or forbidden, which is said.

        Raises `NeedsConfirmation` if the policy wants a yes and nobody has `confirmed` it.
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
        """Answer what is asked of the programs that are kept; False if nothing is."""
        return self._questions.answer(text, turn)

    def drives(self, prepared: Prepared) -> bool:
        """Whether it sets the body in motion, now or later."""
        program = prepared.meaning.program
        return self._programs.drives(program) if program else bool(_driving(prepared))

    def lasts(self, prepared: Prepared) -> bool:
        """Whether what it changes stays when it is over, as a place that is forgotten does."""
        skills = prepared.meaning.agent.every_skill
        return any(skills[call.skill].lasting for call in prepared.meaning.every_call)

    def question(self, prepared: Prepared) -> str:
        """Asks whether it shall be done."""
        phrases, program = self._interpreter.phrases, prepared.meaning.program
        if program:
            return phrases.say("do_this", told=self._programs.in_words(program))
        asked = [one for one in prepared.goals if _is_asked_about(one.skill)] or prepared.goals
        return phrases.question([(goal.skill, goal.arguments) for goal in asked])

    def perform(self, prepared: Prepared, turn: Turn) -> None:
        """Do it, or say why it may not be done."""
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
            self.last.forget()  # of several nobody knows which one was wrong
        if not self._executor.run(prepared.goals, turn, prepared.meaning.source):
            self.last.forget()


def _driving(prepared: Prepared) -> Sequence[Goal]:
    return [goal for goal in prepared.goals if goal.skill.drives]


def _is_asked_about(one: Skill) -> bool:
    """Whether a question names it, beside what only tells something."""
    return one.drives or one.lasting or one.confirm


YES_FROM = 0.6
"""A spoken yes that is less sure to have been said is asked about again. Of 58 by voices that tune,
in quiet and in noise, 55 were surer: nothing moves for a yes that was rather guessed."""


class Asking:
    """Used from the conversation's thread; `question` is shared with whoever stops.

    `confirm` may be set from any thread. A question asks only of what drives, and of what lasts
    where that was not plainly said: whatever tells something is done at once, and so is a stop. A
    program is asked about before it is kept, as its calls would be.
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
        """Answers are in the interpreter's language from now on."""
        self._answers = _answers(self._interpreter.phrases)

    def forget(self) -> None:
        """Nothing is left to correct."""
        self._last.forget()

    def attend(self, text: str, turn: Turn, said_s: float) -> Meaning | None:
        """Do what these words ask for, or ask back; what they mean, None if they were answered.

        `said_s` is when they were said: what was said before a question is no answer to it.
        """
        self.question.expire()
        answer = self._answers.read(text)
        if answer and self._counts(answer, text):
            return self._answered(answer, turn, said_s)
        meaning = self._corrected(text)
        if meaning is None:
            rest = self._unanswered(text)
            if not rest:
                turn.say(self._interpreter.phrases.say("left_undone"))
                return None
            if self._performer.answer(rest, turn):
                return None
            meaning = self._dialogue_skills.meant(self._interpreter.understand(rest, turn), turn)
        if meaning is None or turn.token.cancelled:
            return meaning
        turn.decided(meaning.every_call, meaning.source, meaning.measured)
        meaning = self._interpreter.as_heard(meaning, turn)
        return meaning if self.act(meaning, turn) else None

    def act(self, meaning: Meaning, turn: Turn) -> bool:
        """Do what is meant, or ask first; what the policy wants a yes for is always asked.

        False if it was left for an answer, or for plainer words.
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
        """The same question: the yes was hardly heard."""
        if asked := self.question.asked:
            self._dialogue_skills.confirmed(turn.number, asked.turn)
            self._put(replace(asked, turn=turn.number), turn)

    def _put(self, question: Question, turn: Turn) -> None:
        if self.question.ask(question):
            turn.say(question.text, Outcome.ASKED)

    def _counts(self, answer: Answer, text: str) -> bool:
        """Not where it is a command and no question waits: a robot that walks may "go ahead"."""
        waits = self.question.awaits if answer is Answer.YES else bool(self.question.asked)
        return waits or not self._is_plain(text)

    def _is_plain(self, text: str) -> bool:
        return isinstance(self._interpreter.plain(text), Meaning)

    def _answered(self, answer: Answer, turn: Turn, said_s: float) -> Meaning | None:
        """What is done now, if that is what was asked."""
        if answer is Answer.NO:
            asked = self.question.end(ConfirmationStatus.DECLINED)
            turn.say(self._interpreter.phrases.say("left_undone" if asked else "what_instead"))
            return None
        if not self.question.is_answered_at(said_s):
            turn.say(self._interpreter.phrases.say("nothing_asked"))
            return None
        if turn.hearing < YES_FROM:
            self._ask_again(turn)
            return None
        question = self.question.end(ConfirmationStatus.CONFIRMED)
        if question is None:  # a stop was quicker
            return None
        meaning = question.meaning
        self._dialogue_skills.confirmed(turn.number, question.turn)
        if prepared := self._performer.prepare(meaning, turn, confirmed=True):
            self._performer.perform(prepared, turn)
        return meaning

    def _corrected(self, text: str) -> Meaning | None:
        """What is meant instead of what was asked about, or else of what was begun."""
        asked, drive = self.question.asked, self._last.corrigible
        if asked:
            agent, calls = asked.meaning.agent, asked.meaning.calls
        elif drive:
            agent, calls = drive.agent, (drive.call,)
        else:
            return None
        driving = [call for call in calls if agent.every_skill[call.skill].drives]
        if len(driving) != 1:
            return None
        (wrong,) = driving
        right = correct(
            wrong, agent.every_skill[wrong.skill], text, self._answers, self._interpreter.phrases
        )
        if right is None:
            return None
        self.question.end(ConfirmationStatus.DECLINED)
        return Meaning(agent, tuple(right if c is wrong else c for c in calls), "template")

    def _unanswered(self, text: str) -> str:
        """What is left to understand: all of it, or what follows the no of "no, go to the office".

        Nothing, if a no is followed by words that are no plain command: a question is declined, and
        nobody guesses.
        """
        asked = self.question.asked
        rest = self._answers.after_no(text) if asked or self._last.corrigible else ""
        plain = bool(rest) and self._interpreter.plain(rest) is not None
        if plain or (rest and asked):
            self.question.end(ConfirmationStatus.DECLINED)
            return rest if plain else ""
        self.question.end(ConfirmationStatus.REPLACED)
        return text


def _answers(book: Phrasebook) -> Answers:
    books = (book, book.fallback) if book.fallback else (book,)
    return Answers([one.answers for one in books], spaced=book.hearing.spaced)
