"""What an utterance means: the calls, or the program, and how sure that is."""

from dataclasses import dataclass, replace

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.confidence import ASK_FROM, HEARD_FROM, SURE_FROM
from edgevox.agent.programs.program import Program, calls_of
from edgevox.agent.skills import Call


@dataclass(frozen=True, slots=True)
class Meaning:
    """What to do about an utterance, and who found it out: ``template``, ``reading`` or ``model``.

    `confidence` is that it is meant: 1 for a template; from `SURE_FROM` on it is to be done, below
    that somebody is to be asked. What is to be done later or more than once is a `program`, and
    has no `calls` to do at once.
    """

    agent: Agent
    calls: tuple[Call, ...]
    source: str
    confidence: float = 1.0
    program: Program | None = None

    @property
    def sure(self) -> bool:
        """Whether to do it without asking."""
        return self.confidence >= SURE_FROM

    @property
    def measured(self) -> float | None:
        """How sure it is, where something measured that: nobody knows how sure a model is."""
        return None if self.source == "model" else self.confidence

    def heard(self, confidence: float) -> "Meaning":
        """The same of words that are so sure to have been said: asked about if both are not."""
        if self.confidence * confidence >= HEARD_FROM:
            return self
        return replace(self, confidence=min(self.confidence, ASK_FROM))

    @property
    def every_call(self) -> tuple[Call, ...]:
        """All that may be called, those inside the program too."""
        return calls_of(self.program) if self.program else self.calls
