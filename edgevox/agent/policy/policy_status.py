"""What the policy says of itself: the component `policy`."""

from collections.abc import Callable, Collection

from edgevox.agent.policy.guard import Guard
from edgevox.agent.policy.targets import plain
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

NO_FILE = "no file: only the robot's own limits"


class PolicyComponent:
    """A file that cannot be read, and names that nobody knows, are a warning: the one leaves an old
    policy in force, the others have no effect. A refusal is what a policy is for.

    `skills` are all names that a rule may have on this robot.
    """

    name = ComponentName.POLICY
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, guard: Guard, skills: Callable[[], Collection[str]]) -> None:
        self._guard, self._skills = guard, skills

    def status(self) -> Status:
        """How it is now; looks at whether the file has changed."""
        guard = self._guard
        file = guard.look().file
        found = []
        if guard.fault:
            text = f"the file cannot be used, the policy before it is in force: {guard.fault}"
            found.append(Finding(Level.WARN, text))
        if unknown := sorted(self._unknown()):
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

    def _unknown(self) -> set[str]:
        """Skills and places of the file that are none of this robot."""
        file = self._guard.policy.file
        known = self._guard.around.places()
        places = file.limits.places.names if file.limits.places and known else frozenset()
        return set(file.skills - set(self._skills())) | (places - {plain(one) for one in known})
