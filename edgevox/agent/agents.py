"""Agents: who talks. An app may have several, and one may hand the conversation to another."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

from edgevox.agent.skills import SkillSet
from edgevox.core.errors import InvalidValue


@dataclass(frozen=True)
class Agent:
    """A role in the conversation: instructions, skills, and to whom it may hand over.

    `dialogue_skills` are asked by plain sentences only; a model is not told of them.
    """

    name: str
    instructions: str
    skills: SkillSet = field(default_factory=lambda: SkillSet(()))
    handoffs: tuple[str, ...] = ()
    dialogue_skills: SkillSet = field(default_factory=lambda: SkillSet(()))

    @cached_property
    def every_skill(self) -> SkillSet:
        """What plain sentences can ask of it."""
        return SkillSet([*self.skills.values(), *self.dialogue_skills.values()])


def by_name(agents: Sequence[Agent]) -> dict[str, Agent]:
    """Agents by name, the first one first. Raises `InvalidValue` for a hand-off to nobody."""
    known = {agent.name: agent for agent in agents}
    if not known:
        raise InvalidValue("agents", [], "at least one agent")
    for agent in agents:
        for name in agent.handoffs:
            if name not in known:
                raise InvalidValue(f"{agent.name}.handoffs", name, "one of " + ", ".join(known))
    return known


def skills_of(agents: Sequence[Agent]) -> SkillSet:
    """The skills of all of them; of two that have one name, the last one's."""
    skills = {name: one for agent in agents for name, one in agent.skills.items()}
    return SkillSet(skills.values())
