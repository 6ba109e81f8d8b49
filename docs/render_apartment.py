"""Drives the robot through the apartment and draws the way it took: docs/images/apartment.png."""

from pathlib import Path

from edgevox.core.cancel import CancelToken
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.picture import picture

TOUR = ("kitchen", "office", "bedroom", "living_room")
LAST = (2.9, 1.3)
PICTURE = Path(__file__).parent / "images" / "apartment.png"


def ignore(**feedback: object) -> None:
    """Nobody looks at how far it is."""


def main() -> None:
    """Drive, then draw."""
    with ApartmentRobot(speed=None) as robot:
        for point in (*(robot.places[room] for room in TOUR), LAST):
            robot.drive_to(*point, token=CancelToken(), report=ignore)
        image = picture(
            robot.world,
            robot.pose(),
            robot.movable_poses(),
            trail=robot.trail(),
            scan=robot.scan(),
        )
    PICTURE.parent.mkdir(exist_ok=True)
    image.save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
