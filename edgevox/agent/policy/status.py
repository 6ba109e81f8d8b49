"""The component `policy` of the status."""

import difflib
from collections.abc import Callable, Collection

from edgevox.agent.policy.file import PolicyFile
from edgevox.agent.policy.guard import Guard
from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.policy.policy import NOWHERE
from edgevox.agent.text.same_name import name_form, names_meant
from edgevox.core.errors import shorten
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

_NEAR = 0.6
"""Least similarity, from 0 to 1, of a known name to be suggested for an unknown one."""
NO_FILE = "no file: only the robot's own limits"


class PolicyComponent:
    """The policy in the status.

    A file that cannot be read is a warning, because the old policy stays in force. Unknown names
    are a warning, because they have no effect. Refusals are normal. `skills` returns all names that
    a rule may have on this robot.
    """

    name = ComponentName.POLICY
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, guard: Guard, skills: Callable[[], Collection[str]]) -> None:
        self._guard, self._skills = guard, skills

    def status(self) -> Status:
        """The status now; reads the file again if it has changed."""
        guard = self._guard
        file = guard.look().file
        found = []
        if guard.fault:
            text = f"the file cannot be used, the policy before it is in force: {guard.fault}"
            found.append(Finding(Level.WARN, text))
        if unknown := self._unknown():
            text = f"names that this robot does not know: {', '.join(unknown)}"
            found.append(Finding(Level.WARN, text))
        return Status.judged(
            self.name,
            found,
            well=(file.about or "in force") if guard.has_rules else NO_FILE,
            broken=bool(guard.fault),
            refused=sum(guard.refusals.values()),
            slowed=guard.slowed,
            last_refused=guard.last or None,
        )

    def _unknown(self) -> list[str]:
        return unknown_names(self._guard.policy.file, self._skills(), self._guard.around)


def unknown_names(
    file: PolicyFile, skills: Collection[str], around: PolicyContext = NOWHERE
) -> list[str]:
    """Skills and places of the file that this robot does not have, each with a near known name.

    A place is known by any of its names. A taught place is known only to `never`, because its name
    permits nothing.
    """
    forms = {name_form(one) for one in skills}
    found = [
        _no_such("skill", one, skills)
        for one in sorted(file.skills)
        if one not in skills and name_form(one) not in forms
    ]
    places, own = file.limits.places, around.places()
    if places is None or not own:
        return found
    taught = {one: one for one in around.taught()}
    return found + [
        _no_such("place", one, own)
        for one in sorted(places.names)
        if not around.place_meant(one)
        and not names_meant(one, {name: name for name in own})
        and not (one not in (places.only or ()) and names_meant(one, taught))
    ]


def _no_such(kind: str, name: str, known: Collection[str]) -> str:
    """The finding about an unknown name, with the most similar known one."""
    forms = {name_form(one): one for one in known}
    near = difflib.get_close_matches(name_form(name), forms, n=1, cutoff=_NEAR)
    ask = f"; did you mean {forms[near[0]]}?" if near else ""
    return f"{shorten(name)[1:-1]}: no such {kind}{ask}"
