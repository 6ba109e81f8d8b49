"""One thing that the arm was asked to do, from its start to its end: some motions in a row."""

from collections.abc import Mapping
from typing import Any

from edgevox.robots.capabilities import Report
from edgevox.robots.motion import Motion, Progress
from edgevox.robots.panda.arm_motion import ArmMotion


class Task(Motion):
    """A skill that runs: how far it is, and what for.

    `motions` is how many motions of the arm it will take, about; `motion` is the present one. Once
    somebody ended it, it raises the reason at its next motion.
    """

    def __init__(
        self, skill: str, about: Mapping[str, Any], *, motions: int, report: Report
    ) -> None:
        super().__init__()
        self.phase = "planning"
        self.motion: ArmMotion | None = None
        self._about = {"skill": skill, **about}
        self._report = report
        self._motions = motions
        self._done = 0

    def moved(self) -> None:
        """One motion more is behind."""
        self.motion = None
        self._done += 1

    def restart(self) -> None:
        """It tries again from the beginning."""
        self._done = 0

    def progress(self) -> Progress:
        part = self.motion.progress().part if self.motion else 0.0
        return Progress(min(0.99, (self._done + part) / self._motions))

    def report(self) -> None:
        """Say how far it is."""
        self._report(progress=round(self.progress().part, 3), phase=self.phase)

    def describe(self) -> dict[str, Any]:
        """What `robot_state` says of it, JSON-ready."""
        progress = round(self.progress().part, 3)
        return {**self._about, "phase": self.phase, "progress": progress}
