"""One skill of a robot file: what the agent takes, and what it becomes on a node."""

from dataclasses import dataclass
from typing import Any

from rclpy.node import Node

from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.reasons import because as agent_because
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, SkillPhrases
from edgevox.core.clock import Clock
from edgevox.core.languages import LANGUAGES
from edgevox.core.reason import Reason
from edgevox.ros2.robot_file.argument_models import arguments_model, meanings
from edgevox.ros2.robot_file.live import go_live
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.robot_file_format import Sentences, SkillEntry
from edgevox.ros2.robot_file.skill_run import LiveSkill, Watch, run_skill


@dataclass(eq=False)
class DescribedSkill:
    """One entry of the file with its checked steps; `open` it on a node before it is run."""

    name: str
    entry: SkillEntry
    steps: list[PlannedStep]
    stop: PlannedStep | None
    watches: list[PlannedStep]
    _live: LiveSkill | None = None

    def open(self, node: Node, clock: Clock) -> None:
        """Join the graph with what it needs."""
        self._live = LiveSkill(
            self.name,
            [go_live(one, node, clock) for one in self.steps],
            go_live(self.stop, node, clock) if self.stop else None,
            [Watch(one, node, clock) for one in self.watches],
            clock,
        )

    def close(self) -> None:
        """The node is gone; a run that still goes on ends by its token."""
        self._live = None

    def skill(self) -> Skill:
        """As the agent takes it."""
        entry = self.entry
        said = {ENGLISH: entry, **entry.languages}
        english = words_of(self.name, entry, entry, ENGLISH)
        return Skill(
            name=self.name,
            description=entry.description,
            function=self.run,
            arguments_model=arguments_model(self.name, entry.arguments),
            templates=english.templates,
            says=entry.says,
            done=english.done[0],
            action=entry.asks,
            moves=entry.uses_the_body,
            confirm=entry.confirm,
            phrases={code: words_of(self.name, entry, said.get(code), code) for code in LANGUAGES},
        )

    def run(self, goal: GoalHandle, **arguments: Any) -> Result:
        """Do all steps, one after another. Raises `SkillFailed`, or `Cancelled`."""
        live = self._live
        if live is None:
            raise SkillFailed(agent_because("switched_off"))
        try:
            return run_skill(live, goal, meanings(self.entry.arguments, arguments))
        except SkillFailed as error:
            raise SkillFailed(self._reason(error.reason)) from error

    def _reason(self, found: Reason) -> Reason:
        """What the file says of a failure, in the languages that it speaks."""
        if not self.entry.failed:
            return found
        told = {code: one.failed for code, one in self.entry.languages.items() if one.failed}
        return Reason(
            self.entry.failed, found.code, found.values, {ENGLISH: self.entry.failed, **told}
        )


def words_of(name: str, entry: SkillEntry, said: Sentences | None, code: str) -> SkillPhrases:
    """What is said of it in a language: what the file says, or what is made of its name."""
    said = said or Sentences()
    needed = [key for key, one in entry.arguments.items() if one.default is None]
    plain = " ".join([name.replace("_", " "), *("{" + key + "}" for key in needed)])
    made = (f"[please] {plain} [please]",) if code == ENGLISH else ()
    return SkillPhrases(
        can=said.can,
        actions=(said.asks,) if said.asks else (),
        templates=tuple(said.sentences) or made,
        says=(said.says,) if said.says else (),
        done=(said.done or phrasebook(code).say("program_done"),),
        arguments=said.argument_names,
        words=said.words,
    )
