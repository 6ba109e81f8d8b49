"""`robot-watchman`: the apartment's robot, with one more skill, in two languages."""

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import Field

from edgevox.agent.skills import Example, GoalHandle, Result, Skill, SkillPhrases, skill
from edgevox.core.settings import Settings
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.plugin import Robot
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import World

GERMAN = SkillPhrases(
    can="einen Rundgang durch alle Räume machen",
    templates=(
        "(mach|mache) [bitte] (deinen|einen|{rounds}) (Rundgang|Rundgänge)",
        "sieh [bitte] [überall] nach dem Rechten",
    ),
    says=("Ich mache meinen Rundgang.",),
    actions=("meinen Rundgang machen",),
    done=("Ich habe {seen} Räume gesehen, alles ist ruhig.",),
)


def patrol_skill(body: DiffDriveRobot) -> Skill:
    """Make the skill that drives through every room of the body's world."""

    @skill(
        templates=[
            "[please] (do|make|start) (your round|a round|{rounds} rounds) [please|now]",
            "[please] patrol [the (apartment|rooms)] [{rounds} times] [please|now]",
        ],
        examples=[
            Example("is everything all right in the house?"),
            Example("have a look everywhere, and then once more", {"rounds": 2}),
        ],
        says="Going on my round.",
        action="go on my round",
        done="I have seen {seen} rooms, and all is quiet.",
        phrases={"de": GERMAN},
    )
    def patrol(goal: GoalHandle, rounds: Annotated[int, Field(ge=1, le=5)] = 1) -> Result:
        """Drive through every room, one after another, once or several times."""
        rooms = list(body.places.values()) * rounds
        for number, (x_m, y_m) in enumerate(rooms):
            body.drive_to(x_m, y_m, token=goal.token, report=_part(goal, number, len(rooms)))
        return {"seen": len(rooms)}

    return patrol


def _part(goal: GoalHandle, number: int, count: int) -> Callable[..., None]:
    """Report the progress of one drive as a part of the whole round."""

    def report(**feedback: Any) -> None:
        goal.report(**feedback | {"progress": round((number + feedback["progress"]) / count, 3)})

    return report


class Watchman(DiffDriveRobot):
    """The apartment's robot with one more skill."""

    def __init__(self, world: World, speed: float | None) -> None:
        super().__init__("robot-watchman", world, PymunkEngine(world), speed=speed)

    @property
    def skills(self) -> tuple[Skill, ...]:
        return (*super().skills, patrol_skill(self))


def _build(settings: Settings, speed: float | None) -> Watchman:
    return Watchman(load_world(settings.world, seed=settings.seed), speed)


WATCHMAN = Robot("the apartment's robot, which also goes on patrol", _build)
