"""Agents, the roles that talk: an app may have several, and one may hand over to another."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

from edgevox.agent.skills import SkillSet
from edgevox.core.errors import InvalidValue


@dataclass(frozen=True)
class Agent:
    """A role in the conversation."""

    name: str
    """The name, unique among the agents."""
    instructions: str
    """Instructions for the language model."""
    skills: SkillSet = field(default_factory=lambda: SkillSet(()))
    """Skills that sentences may call."""
    handoffs: tuple[str, ...] = ()
    """Names of the agents to which this one may hand over."""
    dialogue_skills: SkillSet = field(default_factory=lambda: SkillSet(()))
    """Skills that only plain sentences may call; the language model is not told of them."""

    @cached_property
    def every_skill(self) -> SkillSet:
        """All skills that plain sentences may call."""
        return SkillSet([*self.skills.values(), *self.dialogue_skills.values()])


def by_name(agents: Sequence[Agent]) -> dict[str, Agent]:
    """Agents by name, in their order. Raises `InvalidValue` for a hand-off to an unknown name."""
    known = {agent.name: agent for agent in agents}
    if not known:
        raise InvalidValue("agents", [], "at least one agent")
    for agent in agents:
        for name in agent.handoffs:
            if name not in known:
                raise InvalidValue(f"{agent.name}.handoffs", name, "one of " + ", ".join(known))
    return known


def skills_of(agents: Sequence[Agent]) -> SkillSet:
    """The skills of all agents; of two skills with the same name, the later one."""
    skills = {name: one for agent in agents for name, one in agent.skills.items()}
    return SkillSet(skills.values())
