"""The file of remembered places: JSON, in a folder that survives restarts, whole at every moment.

    {"version": 1, "places": [{"robot": "robot-apartment", "world": "apartment", "name": "charger",
                               "x": 6.4, "y": 2.1, "yaw": 1.57, "frame": "map"}]}

All robots of a machine may share a folder: who writes holds a lock, reads what stands there, and
changes only places of its own robot and world. A name is data in it, never a part of a path.
"""

import fcntl
import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from edgevox.core.atomic_file import write_atomically
from edgevox.core.errors import InvalidValue
from edgevox.core.json_reader import read_json_object
from edgevox.core.log import get_logger
from edgevox.core.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.validation import dotted, explain

log = get_logger(__name__)

NAME = "places.json"
_LOCK = ".places.lock"
_Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]
_Text = Annotated[str, Field(min_length=1, max_length=200)]


class Place(BaseModel):
    """A point of a world that was given a name: where a robot stood, or one that was told.

    Metres and radians (counter-clockwise from x) in `frame`; `yaw` is None where nobody stood.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    robot: _Text
    world: _Text
    name: _Text
    x: _Number
    y: _Number
    yaw: _Number | None
    frame: _Text = "map"


class _File(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    version: Literal[1]
    places: list[Place]


Change = Callable[[Sequence[Place]], Sequence[Place]]


class PlaceStore:
    """The places of all robots in one folder. Every method may be called from any thread."""

    def __init__(self, folder: Path) -> None:
        self.file = folder.expanduser().absolute() / NAME

    def load(self) -> Sequence[Place]:
        """All that is remembered; nothing where there is no file yet.

        A file that is none of ours is kept aside and named in the log, with its first wrong field.
        Raises `OSError` where that cannot be done, or nothing can be read.
        """
        try:
            return self._parse()
        except InvalidValue:
            with self._locked():
                return self._read()

    def change(self, change: Change) -> Sequence[Place]:
        """Put what `change` makes of the places into their place; what there is then.

        Raises `OSError`, and then the file is as it was.
        """
        self.file.parent.mkdir(parents=True, exist_ok=True)
        with self._locked():
            places = change(self._read())
            data = {"version": 1, "places": [one.model_dump() for one in places]}
            text = json.dumps(data, ensure_ascii=False, indent=1) + "\n"
            if len(text.encode()) > LARGEST_TEXT_BYTES:
                raise OSError(f"{NAME} would be larger than {LARGEST_TEXT_BYTES} bytes")
            write_atomically(self.file, text)
            return places

    def _read(self) -> Sequence[Place]:
        """As it is, by who holds the lock."""
        try:
            return self._parse()
        except InvalidValue as error:
            log.error("places_kept_aside", file=str(self._keep_aside()), reason=str(error))  # noqa: TRY400 - the reason says it all
            return ()

    def _parse(self) -> Sequence[Place]:
        """Raises `OSError`, or `InvalidValue` naming the file and the field."""
        if not self.file.exists():
            return ()
        self.file.open("rb").close()  # what cannot be read need not be wrong
        return _parse(read_text(self.file, str(self.file)), self.file)

    def _keep_aside(self) -> Path:
        """Rename what cannot be read to a name that nothing has."""
        names = (self.file.with_name(f"{NAME}.broken-{number}") for number in range(1, 10_000))
        aside = next(name for name in names if not os.path.lexists(name))
        os.rename(self.file, aside)
        return aside

    @contextmanager
    def _locked(self) -> Iterator[None]:
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        number = os.open(self.file.with_name(_LOCK), flags, 0o600)
        try:
            fcntl.flock(number, fcntl.LOCK_EX)
            yield
        finally:
            os.close(number)


def _parse(text: str, file: Path) -> Sequence[Place]:
    """Raises `InvalidValue` naming the file and the field."""
    data = read_json_object(text, str(file), largest_bytes=LARGEST_TEXT_BYTES)
    try:
        return tuple(_File.model_validate_json(json.dumps(data)).places)
    except ValidationError as error:
        raise explain(error, lambda place: f"{file}: {dotted(place)}") from None
