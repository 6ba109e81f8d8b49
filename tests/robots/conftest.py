"""Robots in worlds whose time the test holds, or whose time passes as fast as it can."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from engines import MeddledEngine, meddled

from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.irsim import IrsimRobot
from edgevox.robots.world.load import parse_world

HALL = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 2, 0]
  vel_max: [0.8, 2.0]
  acce: [1.5, 6.0]
"""


Make = Callable[..., DiffDriveRobot]
Held = Callable[..., Any]


@pytest.fixture
def held() -> Iterator[Held]:
    """Starts a body in a world whose time passes only as far as the test says (`held_time`)."""
    with ExitStack() as stack:
        yield lambda make, *about: stack.enter_context(make(*about, speed=0.0))


@pytest.fixture(params=[ApartmentRobot, IrsimRobot], ids=["apartment", "irsim"])
def make(request: pytest.FixtureRequest) -> Make:
    """Both 2D bodies: whatever a test asks of one, it asks of the other."""
    return request.param


@pytest.fixture
def robot(make: Make) -> Iterator[DiffDriveRobot]:
    """In the apartment, where time passes as fast as it can while it drives."""
    with make(speed=None) as one:
        yield one


@pytest.fixture
def in_hall(make: Make) -> Iterator[Callable[[str], DiffDriveRobot]]:
    """In an empty hall of 8 x 4 m, at x = 1 and looking along x, plus what the test adds."""
    made: list[DiffDriveRobot] = []

    def build(more: str = "", speed: float | None = None) -> DiffDriveRobot:
        made.append(make(parse_world(HALL + more, "hall.yaml"), speed=speed))
        made[-1].start()
        return made[-1]

    yield build
    for one in made:
        one.close()


@pytest.fixture
def meddled_hall(make: Make) -> Iterator[Callable[[str], tuple[DiffDriveRobot, MeddledEngine]]]:
    """As `in_hall`, where time passes only as told, with the engine in the test's hands."""
    with ExitStack() as stack:

        def build(more: str = "") -> tuple[DiffDriveRobot, MeddledEngine]:
            robot, engine = meddled(make, parse_world(HALL + more, "hall.yaml"), speed=0.0)
            return stack.enter_context(robot), engine

        yield build


@pytest.fixture
def held_robot(make: Make, held: Held) -> DiffDriveRobot:
    """In the apartment, where time stands still until it is told."""
    return held(make)
