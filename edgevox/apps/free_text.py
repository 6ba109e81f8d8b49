"""Which arguments of skills may hold what somebody said."""

from collections.abc import Callable, Sequence

from edgevox.agent.agents import Agent


def free_text(agents: Sequence[Agent]) -> Callable[[str, str], bool]:
    """Whether an argument, by its skill's name and its own, takes any words.

    One of a skill that nobody has counts as such.
    """
    free = {name: one.free_text for agent in agents for name, one in agent.skills.items()}
    return lambda skill, argument: skill not in free or argument in free[skill]
