"""Why a skill does not do what was asked, as what is raised and as a reason that people hear."""

from collections.abc import Iterable

from edgevox.agent.reasons import because
from edgevox.agent.wrong_arguments import WrongArgument, spoken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.reason import Reason


class SkillFailed(EdgeVoxError):
    """A skill could not do what was asked. The message is a reason that a person may hear.

    A `Reason` with a code is said in the language that is spoken, a plain sentence as it is.
    """

    def __init__(self, reason: Reason | str) -> None:
        self.reason = reason if isinstance(reason, Reason) else Reason(reason)
        super().__init__(self.reason.text)


def reason_of(error: EdgeVoxError) -> Reason:
    """Why something was not done, from what was raised."""
    if isinstance(error, WrongArgument):
        return error.why
    return error.reason if isinstance(error, SkillFailed) else Reason(str(error))


class UnknownSkill(WrongArgument):
    """A call names a skill that this agent does not have."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        names = tuple(known)

        def why(text: str) -> Reason:
            return because("unknown_skill", text, skill=spoken(name), skills=names)

        super().__init__("skill", name, "one of " + ", ".join(names), why)
