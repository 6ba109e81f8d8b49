"""A picture of a body, as a PNG file."""

import os
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import PUBLIC, write_atomically
from edgevox.robots.capabilities import Advances, Body, HasPicture
from edgevox.robots.pictures import png_of

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
