"""The file of remembered places: JSON, in a folder that survives restarts, whole at every moment.

    {"version": 1, "places": [{"robot": "robot-apartment", "world": "apartment", "name": "charger",
        "x": 6.4, "y": 2.1, "yaw": 1.57, "frame": "map"}]}

All robots of a machine may share a folder: a writer holds a lock, reads the present content, and
changes only places of its own robot and world. A name is data in it, never a part of a path.
`check_new_name` decides which names people may give.
"""

import fcntl
import json
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from edgevox.agent.phrases.name_rules import check_name, is_clause_word, is_sentence
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import name_form, names_meant, names_near
from edgevox.core.errors import InvalidValue
from edgevox.core.files.json_reader import read_json_object
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.files.validation import dotted, explain
from edgevox.robots.names import LONGEST_PLACE, speakable

MOST_PLACES = 200


def check_new_name(name: str, own: Mapping[str, str]) -> None:
    """Raise `SkillFailed` with the reason why no place may ever be called so.

    `own` is what people say for the places of the map, as `name_rules.names_of` gives it.
    """
    if len(name) > LONGEST_PLACE:
        raise SkillFailed(because("place_name_long", limit=str(LONGEST_PLACE)))
    if not speakable(name) or name != " ".join(name.split()):
        raise SkillFailed(because("place_name_wrong"))
    try:
        check_name("name", name)
    except InvalidValue:
        raise SkillFailed(because("place_name_reserved", name=name)) from None
    if is_clause_word(name) or not name_form(name):
        raise SkillFailed(because("place_name_reserved", name=name))
    if rooms := names_meant(name, own) or names_near(name, own):
        raise SkillFailed(because("place_of_the_map", place=rooms[0].replace("_", " ")))
    if is_sentence(name, own):
        raise SkillFailed(because("place_name_reserved", name=name))


def is_fit(name: str, own: Mapping[str, str]) -> bool:
    """Return whether a place may have this name, besides those of the map."""
    try:
        check_new_name(name, own)
    except SkillFailed:
        return False
    return True


NAME = "places.json"
_LOCK = ".places.lock"
_EXPECTED = f"at most {MOST_PLACES} places"
_Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]
_Text = Annotated[str, Field(min_length=1, max_length=200)]


class Place(BaseModel):
    """A named point of a world: where a robot stood, or a point that was told.

    Metres and radians (counter-clockwise from x) in `frame`; `yaw` is None for a point that was
    told.
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
        self._state = StateFiles()

    @property
    def fault(self) -> str:
        """The file that could not be read and was kept aside; empty if there was none."""
        return self._state.fault

    def load(self) -> Sequence[Place]:
        """All that is remembered; nothing where there is no file yet, or none that can be used.

        Such a file is kept aside and named in the log, with its first wrong field. Raises `OSError`
        where nothing can be read.
        """
        if not os.path.lexists(self.file):
            return ()
        try:
            return self._parse(read_text(self.file, str(self.file)))
        except InvalidValue:
            pass  # whoever renames a file holds the lock: it may be another by now
        try:
            with self._locked():
                return self._read() or ()
        except OSError:  # a disk that takes no lock takes no other name for the file, either
            return self._read() or ()

    def change(self, change: Change) -> Sequence[Place]:
        """Put what `change` makes of the places into their place; what there is then.

        Raises `OSError`, and then the file is as it was.
        """
        self.file.parent.mkdir(parents=True, exist_ok=True)
        with self._locked():
            known = self._read()
            if known is None and os.path.lexists(self.file):
                raise OSError(f"{NAME} is damaged and could not be kept aside")
            places = change(known or ())
            if _too_many(places):
                raise OSError(f"{NAME} would hold more: expected {_EXPECTED} of one robot")
            data = {"version": 1, "places": [one.model_dump() for one in places]}
            text = json.dumps(data, ensure_ascii=False, indent=1) + "\n"
            if len(text.encode()) > LARGEST_TEXT_BYTES:
                raise OSError(f"{NAME} would be larger than {LARGEST_TEXT_BYTES} bytes")
            write_atomically(self.file, text)
            return places

    def _read(self) -> Sequence[Place] | None:
        """Read the places, under the lock; None if there is no file. Raises `OSError`."""
        return self._state.read(self.file, self._parse)

    def _parse(self, text: str) -> Sequence[Place]:
        """Raises `InvalidValue` naming the file and the field."""
        data = read_json_object(text, str(self.file), largest_bytes=LARGEST_TEXT_BYTES)
        try:
            places = tuple(_File.model_validate_json(json.dumps(data)).places)
        except ValidationError as error:
            raise explain(error, lambda place: f"{self.file}: {dotted(place)}") from None
        if most := _too_many(places):
            raise InvalidValue(f"{self.file}: places", f"{most} of one robot and world", _EXPECTED)
        return places

    @contextmanager
    def _locked(self) -> Iterator[None]:
        lock = self.file.with_name(_LOCK)
        self._state.read(lock, str)  # what is no file there is kept aside, too
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        number = os.open(lock, flags, 0o600)
        try:
            fcntl.flock(number, fcntl.LOCK_EX)
            yield
        finally:
            os.close(number)


def _too_many(places: Sequence[Place]) -> int:
    """Return one robot's number of places in a world, if that exceeds the limit; else 0."""
    each = Counter((one.robot, one.world) for one in places)
    most = max(each.values(), default=0)
    return most if most > MOST_PLACES else 0
