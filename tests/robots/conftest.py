"""Robots in worlds whose time passes as fast as it can."""

import threading
from collections.abc import Callable, Iterator

import pytest

from edgevox.core.cancel import CancelToken
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.irsim import IrsimRobot
from edgevox.robots.planar import PlanarRobot
from edgevox.robots.world import parse_world

HALL = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 2, 0]
  vel_max: [0.8, 2.0]
  acce: [1.5, 6.0]
"""


class Driving:
    """A drive on a thread of its own, as a goal runs it."""

    def __init__(self, robot: PlanarRobot, x_m: float, y_m: float) -> None:
        self.token = CancelToken()
        self.reports: list[dict[str, float]] = []
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, args=(robot, x_m, y_m))
        self._thread.start()
        while robot.state()["goal"] is None and self._thread.is_alive():
            robot.advance(0.02)

    def _run(self, robot: PlanarRobot, x_m: float, y_m: float) -> None:
        try:
            robot.drive_to(x_m, y_m, token=self.token, report=lambda **f: self.reports.append(f))
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error

    def end(self) -> BaseException | None:
        """Wait for it; what it raised, if anything."""
        self._thread.join(20)
        assert not self._thread.is_alive()
        return self.error


Make = Callable[..., PlanarRobot]


@pytest.fixture(params=[ApartmentRobot, IrsimRobot], ids=["apartment", "irsim"])
def make(request: pytest.FixtureRequest) -> Make:
    """Both 2D bodies: whatever a test asks of one, it asks of the other."""
    return request.param


@pytest.fixture
def robot(make: Make) -> Iterator[PlanarRobot]:
    """In the apartment."""
    with make(speed=None) as one:
        yield one


@pytest.fixture
def in_hall(make: Make) -> Iterator[Callable[[str], PlanarRobot]]:
    """In an empty hall of 8 x 4 m, at x = 1 and looking along x, plus what the test adds."""
    made: list[PlanarRobot] = []

    def build(more: str = "", speed: float | None = None) -> PlanarRobot:
        made.append(make(parse_world(HALL + more, "hall.yaml"), speed=speed))
        made[-1].start()
        return made[-1]

    yield build
    for one in made:
        one.close()


@pytest.fixture
def slow_robot(make: Make) -> Iterator[PlanarRobot]:
    """In the apartment, where a second takes 0.1 s: slow enough to interfere."""
    with make(speed=10.0) as one:
        yield one


@pytest.fixture
def driving() -> type[Driving]:
    return Driving
