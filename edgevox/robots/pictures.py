"""Pictures of a robot and by it, as PNG files; the skill that takes one, and their folder."""

import io
import os
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.agent.text.reasons import because
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import PictureTaken
from edgevox.core.files.state_files import PUBLIC, write_atomically
from edgevox.core.files.user_file import size_bytes
from edgevox.core.log import get_logger
from edgevox.robots.capabilities import Advances, Body, HasCamera, HasPicture, ReceivesPictures

log = get_logger(__name__)

_NAME = "picture-{:%Y%m%d-%H%M%S-%f}.png"
_FILES, _PARTIAL = "picture-*.png", ".picture-*.partial"


class Album:
    """A folder of PNG files, of which the oldest go for new ones. One robot may use it."""

    def __init__(
        self, folder: Path, most_bytes: int, today: Callable[[], datetime] = datetime.now
    ) -> None:
        """All pictures together take at most `most_bytes`, or are the newest one alone."""
        self._folder = folder.expanduser().absolute()
        self._most_bytes = most_bytes
        self._today = today

    def keep(self, png: bytes) -> Path:
        """Write a picture and return its file. Raises `OSError`."""
        self._folder.mkdir(parents=True, exist_ok=True)
        for left in self._folder.glob(_PARTIAL):  # by a process that was killed
            left.unlink(missing_ok=True)
        left_bytes = self._most_bytes - len(png)
        for kept in sorted(self._folder.glob(_FILES), reverse=True):
            left_bytes -= size_bytes(kept)
            if left_bytes < 0:
                kept.unlink(missing_ok=True)
        file = self._folder / _NAME.format(self._today())
        write_atomically(file, png, PUBLIC)
        return file


def has_camera(body: Body) -> bool:
    """True for a body with a camera, its own or one whose pictures it hears."""
    return isinstance(body, HasCamera | ReceivesPictures)


def picture_skills(
    body: Body, album: Album, taken: Callable[[PictureTaken], None]
) -> tuple[Skill, ...]:
    """`take_picture`, for a body with a camera.

    `taken` hears of each picture, also of one that cannot be kept.
    """

    @skill(moves=False, plainly=True)
    def take_picture(goal: GoalHandle) -> Result:
        """Take a picture with the camera, and keep it as a PNG file."""
        goal.token.check()
        png = png_of(_seen(body))
        try:
            file = album.keep(png)
        except OSError as error:
            taken(PictureTaken(png, ""))
            log.warning("picture_not_kept", reason=str(error))
            raise SkillFailed(because("picture_not_kept")) from error
        taken(PictureTaken(png, str(file)))
        return {"folder": file.parent.name, "file": str(file)}

    return (take_picture,) if has_camera(body) else ()


def no_camera() -> Skill:
    """The same skill of a body without a camera, which only says so."""

    @skill(moves=False)
    def take_picture(goal: GoalHandle) -> Result:
        """Say that the robot has no camera."""
        goal.token.check()
        return {}

    return take_picture


def png_of(pixels: NDArray[np.uint8]) -> bytes:
    """A picture, shape (height, width, 3), RGB, as a PNG file."""
    from PIL import Image  # which only pictures need

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, format="PNG")
    return file.getvalue()


def _seen(body: Body) -> NDArray[np.uint8]:
    """What the camera sees now. Raises `SkillFailed`."""
    pixels: NDArray[np.uint8] | None = None
    try:
        if isinstance(body, HasCamera):
            pixels = body.camera().pixels
        elif isinstance(body, ReceivesPictures):
            pixels = body.newest_picture()
    except EdgeVoxError as error:
        log.warning("no_picture", reason=str(error))
    if pixels is None:
        raise SkillFailed(because("no_picture"))
    return pixels


MOMENT_S = 1.0
"""Seconds before a picture, in which things fall to rest."""


def check_picture(body: Body, file: Path) -> HasPicture:
    """The body, as one that can be drawn into this file. Raises `InvalidValue`."""
    if not isinstance(body, HasPicture):
        raise InvalidValue("snapshot", body.name, "a robot that can show itself")
    if file.is_dir() or not os.access(file.absolute().parent, os.W_OK):
        raise InvalidValue("snapshot", str(file), "a file in a folder that can be written")
    return body


def take_snapshot(body: Body, file: Path) -> bool:
    """Start the body, let a moment pass in its world, write the picture, and close it; True."""
    shown = check_picture(body, file)
    try:
        body.start()
        if isinstance(body, Advances):
            body.advance(MOMENT_S)
        write_picture(shown, file)
    finally:
        body.close()
    return True


def write_picture(body: HasPicture, file: Path) -> None:
    """Write the picture; the file is whole or as it was. Raises `InvalidValue` if it cannot be."""
    png = png_of(body.picture())
    try:
        write_atomically(file.absolute(), png, PUBLIC)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidValue(
            "snapshot", str(file), f"a file that can be written ({reason})"
        ) from None
