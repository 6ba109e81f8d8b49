"""`Performer` checks a meaning, and runs its calls now or keeps its program for later."""

from collections.abc import Sequence
from dataclasses import dataclass

from edgevox.agent.dialogue.memory import DriveCall, LastDrive
from edgevox.agent.dialogue.skills import DialogueSkills
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.questions import ProgramQuestions
from edgevox.agent.skills import Call, Skill
from edgevox.agent.turn import Turn


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

    def question(self, prepared: Prepared, *, goes: bool = False) -> str:
        """The question whether to do it, or if it `goes` the sentence that it will be done."""
        phrases, program = self._interpreter.phrases, prepared.meaning.program
        if program:
            return phrases.say("do_this", told=self._programs.in_words(program))
        asked = [one for one in prepared.goals if _is_asked_about(one.skill)] or prepared.goals
        calls = [(goal.skill, goal.arguments) for goal in asked]
        return phrases.announcement(calls) if goes else phrases.question(calls)

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
