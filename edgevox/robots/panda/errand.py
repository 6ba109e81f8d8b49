"""One thing that the arm was asked to do, from its start to its end."""

from collections.abc import Mapping
from typing import Any

from edgevox.core.cancel import CancelToken
from edgevox.robots.capabilities import Report


class Errand:
    """A skill that runs: who may end it, how far it is, and what for.

    `motions` is how many motions it will take, about. `ended` is what it raises at its next
    motion, once somebody ended it.
    """

    def __init__(
        self,
        skill: str,
        about: Mapping[str, Any],
        *,
        motions: int,
        token: CancelToken,
        report: Report,
    ) -> None:
        self.skill = skill
        self.about = dict(about)
        self.token = token
        self.report = report
        self.phase = "planning"
        self.ended: BaseException | None = None
        self._motions = motions
        self._done = 0

    def moved(self) -> None:
        """One motion more is behind."""
        self._done += 1

    def restart(self) -> None:
        """It tries again from the beginning."""
        self._done = 0

    def progress(self, part: float) -> float:
        """0 to 1, when `part` of the present motion is behind."""
        return min(0.99, (self._done + part) / self._motions)

    def describe(self, part: float) -> dict[str, Any]:
        """What `robot_state` says of it, JSON-ready."""
        return {
            "skill": self.skill,
            **self.about,
            "phase": self.phase,
            "progress": round(self.progress(part), 3),
        }
