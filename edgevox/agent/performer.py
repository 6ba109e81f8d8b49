"""Does what words mean: runs the calls of a meaning now, or keeps its program."""

from collections.abc import Sequence
from dataclasses import dataclass

from edgevox.agent.dialogue_skills import DialogueSkills
from edgevox.agent.goals import Goal
from edgevox.agent.last_drive import DriveCall, LastDrive
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.spoken import ProgramQuestions
from edgevox.agent.skill_executor import SkillExecutor
from edgevox.agent.skills import Call, Skill
from edgevox.agent.turn import Turn


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
