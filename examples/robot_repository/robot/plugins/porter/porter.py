"""`robot-porter`: the robot of `world.yaml`, with one more skill."""

from typing import Annotated

from pydantic import Field

from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.core.settings import Settings
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.plugin import Robot
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import World


def deliver_skill(body: DiffDriveRobot) -> Skill:
    """From the lobby to the pharmacy, as often as there are parcels."""

    @skill(
        templates=["[please] deliver (a parcel|the parcel|{parcels} parcels) [please|now]"],
        says="Delivering.",
        action="deliver a parcel",
        done="I have delivered {delivered} parcels.",
    )
    def deliver(goal: GoalHandle, parcels: Annotated[int, Field(ge=1, le=5)] = 1) -> Result:
        """Bring parcels from the lobby to the pharmacy, one at a time."""
        for _ in range(parcels):
            for room in ("lobby", "pharmacy"):
                body.drive_to(*body.places[room], token=goal.token, report=goal.report)
        return {"delivered": parcels}

    return deliver


class Porter(DiffDriveRobot):
    """Whatever the simulated robot can do, and this."""

    def __init__(self, world: World, speed: float | None) -> None:
        super().__init__("robot-porter", world, PymunkEngine(world), speed=speed)

    @property
    def skills(self) -> tuple[Skill, ...]:
        return (*super().skills, deliver_skill(self))


def _build(settings: Settings, speed: float | None) -> Porter:
    return Porter(load_world(settings.world, seed=settings.seed), speed)


PORTER = Robot("a porter that delivers parcels", _build)
