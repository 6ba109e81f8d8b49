"""Tasks and motions of the arm.

A `Task` is a skill in progress, made of several motions. An `ArmMotion` is one motion of the
motors: the joint angles that they follow, and the test for its end. The angles are computed, period
by period, before the motion starts.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.robots.capabilities import Report
from edgevox.robots.motion import Motion, Progress

Rows = NDArray[np.float64]
"""(n, joints) radians, one row a control period."""

PEAK = 1.875
"""The ratio of the profile's top speed, in its middle, to its mean."""
_SHORTEST_S = 0.24


@dataclass(frozen=True, slots=True)
class Pace:
    """The top speeds of the hand in the room (m/s) and of any joint (rad/s)."""

    hand_m_s: float
    joint_rad_s: float


BRISK = Pace(0.60, 1.9)
CAREFUL = Pace(0.25, 1.0)


def written(
    knots: Rows, points: NDArray[np.float64], pace: Pace, period_s: float, lead_s: float
) -> Rows:
    """Return rows from the first knot to the last, at rest at both ends, within `pace`.

    `points` (n, 3) metres are the hand's places at the knots. The rows run ahead by `lead_s`,
    because motors follow their target with that delay.
    """
    spent = np.concatenate([[0.0], np.cumsum(_durations(knots, points, pace))])
    if spent[-1] < period_s / 10:
        return knots[-1:].copy()
    duration_s = max(_SHORTEST_S, PEAK * spent[-1])
    periods = int(np.ceil(duration_s / period_s))
    part = np.arange(1, periods + 1) / periods
    way = part**3 * (10.0 + part * (6.0 * part - 15.0))
    rows = _through(knots, spent / spent[-1], way)
    ahead = (rows[1:] - rows[:-1]) * (lead_s / period_s)
    rows[1:-1] += (ahead[1:] + ahead[:-1]) / 2
    return rows


def steps(distances: Sequence[float], longest: Sequence[float]) -> int:
    """Into how many equal parts (1 or more) a way is cut, so that none is longer than allowed."""
    return max(
        1, *(int(np.ceil(d / most - 1e-9)) for d, most in zip(distances, longest, strict=True))
    )


def _durations(knots: Rows, points: NDArray[np.float64], pace: Pace) -> NDArray[np.float64]:
    """(n - 1,) seconds between knots at full pace."""
    hand = np.linalg.norm(np.diff(points, axis=0), axis=1) / pace.hand_m_s
    joints = np.abs(np.diff(knots, axis=0)).max(axis=1) / pace.joint_rad_s
    slowest: NDArray[np.float64] = np.maximum(hand, joints)
    return slowest


def _through(knots: Rows, at: NDArray[np.float64], way: NDArray[np.float64]) -> Rows:
    """The curve through `knots`, which it passes at `at` (0 to 1, rising), read at `way`."""
    keep = np.concatenate([[True], np.diff(at) > 1e-9])
    knots, at = knots[keep], at[keep]
    slopes = _slopes(knots, at)
    after = np.clip(np.searchsorted(at, way), 1, len(at) - 1)
    width = (at[after] - at[after - 1])[:, None]
    t = (way[:, None] - at[after - 1][:, None]) / width
    start, end = knots[after - 1], knots[after]
    return (
        start * (1.0 + t * t * (2.0 * t - 3.0))
        + end * t * t * (3.0 - 2.0 * t)
        + slopes[after - 1] * width * t * (t - 1.0) ** 2
        + slopes[after] * width * t * t * (t - 1.0)
    )


def _slopes(knots: Rows, at: NDArray[np.float64]) -> Rows:
    """(n, joints): how the curve runs through each knot, between the lines to its neighbours."""
    width = (at[1:] - at[:-1])[:, None]
    lines = (knots[1:] - knots[:-1]) / width
    slopes = np.empty_like(knots)
    slopes[0], slopes[-1] = lines[0], lines[-1]
    slopes[1:-1] = (lines[:-1] * width[1:] + lines[1:] * width[:-1]) / (width[:-1] + width[1:])
    return slopes


NO_ROWS: Rows = np.zeros((0, 7))


class ArmMotion(Motion):
    """Follows `rows`, a period each, then waits `least` to `patience` periods until `settled`."""

    def __init__(
        self,
        rows: Rows = NO_ROWS,
        *,
        settled: Callable[[], bool],
        patience: int,
        least: int = 1,
        impatient: BaseException | None = None,
    ) -> None:
        super().__init__()
        self.rows = rows
        self.row = 0
        self.settled = settled
        self.left = patience
        self.least = least
        self.impatient = impatient

    def progress(self) -> Progress:
        return Progress(self.row / len(self.rows) if len(self.rows) else 0.0)


class Task(Motion):
    """A skill in progress: its task, its progress and its present motion.

    `motions` is the approximate number of arm motions; `motion` is the present one. After an early
    end, the next motion raises the reason.
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
        """Count one more motion as done."""
        self.motion = None
        self._done += 1

    def restart(self) -> None:
        """Start again from the beginning."""
        self._done = 0

    def progress(self) -> Progress:
        part = self.motion.progress().part if self.motion else 0.0
        return Progress(min(0.99, (self._done + part) / self._motions))

    def report(self) -> None:
        """Say how far it is."""
        self._report(progress=round(self.progress().part, 3), phase=self.phase)

    def describe(self) -> dict[str, Any]:
        """Return the task's part of `robot_state`, JSON-ready."""
        progress = round(self.progress().part, 3)
        return {**self._about, "phase": self.phase, "progress": progress}
