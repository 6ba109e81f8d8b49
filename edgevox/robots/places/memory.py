"""A robot's memory of places in one world, with forgetting, and its file.

The file is JSON, in a folder that survives restarts, whole at every moment.

    {"version": 1, "places": [{"robot": "robot-apartment", "world": "apartment", "name": "charger",
        "x": 6.4, "y": 2.1, "yaw": 1.57, "frame": "map"}]}

All robots of a machine may share a folder: a writer holds a lock, reads the present content, and
changes only places of its own robot and world. A name is data in it, never a part of a path.
`check_new_name` decides which names people may give.
"""

import fcntl
import json
import os
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from edgevox.agent.phrases.name_rules import (
    check_name,
    is_clause_word,
    is_sentence,
    names_of,
    word_meant,
)
from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import name_form, names_meant, names_near
from edgevox.core.errors import InvalidValue, shorten
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.files.validation import dotted, explain, read_json_object
from edgevox.core.log import Said, get_logger
from edgevox.core.transforms import Pose2D
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


log = get_logger(__name__)

_MOST_TOLD = 5
"""The most unusable places that are named in the log."""


class PlaceMemory:
    """Places by name, besides the world's own (`own`, with their names).

    Until a file is opened, places last as long as the object. `names`, `points` and `find` may be
    called from any thread and never wait; a change waits for the disk.
    """

    def __init__(self, world: str, own: OneOf) -> None:
        self.own = own
        self._world = world
        self._robot = ""
        self._store: PlaceStore | None = None
        self._unread = ""
        self._changing = threading.Lock()
        self._places: Mapping[str, Place] = MappingProxyType({})

    def open(self, store: PlaceStore, robot: str) -> None:
        """Take in what this robot remembers of this world, and write there from now on.

        A place whose name has become the world's, may not be one, or is that of another place,
        stays in the file unused, and is named in the log.
        """
        with self._changing:
            self._robot, self._store = robot, store
            self._unread = ""
            try:
                self._take(store.load())
            except OSError as error:
                self._unread = f"{store.file.name} cannot be read ({error.strerror or error})"
                log.error("places_unread", file=str(store.file), reason=str(error))  # noqa: TRY400 - the reason says it all

    @property
    def fault(self) -> str:
        """The reason why remembered places may be missing; empty if none are."""
        return self._unread or (self._store.fault if self._store else "")

    def names(self) -> tuple[str, ...]:
        """Return the remembered names, the oldest first."""
        return tuple(self._places)

    def points(self) -> Mapping[str, tuple[float, float]]:
        """Return the places' points by name, in metres."""
        return {name: (one.x, one.y) for name, one in self._places.items()}

    def find(self, name: str) -> Place | None:
        """The place of exactly this name."""
        return self._places.get(name)

    def check(self, name: str) -> None:
        """Raise `SkillFailed` with the reason why nothing may be called so now."""
        check_new_name(name, self._said_for_own)
        known = word_meant(name, OneOf(self.names()))
        if known and (place := self.find(known)):
            point = {"x": f"{place.x:.1f}", "y": f"{place.y:.1f}"}
            raise SkillFailed(because("place_known", place=_said(known), **point))
        if len(self._places) >= MOST_PLACES:
            raise SkillFailed(because("places_full", count=str(MOST_PLACES)))

    def remember(self, name: str, pose: Pose2D, frame: str, *, facing: bool = True) -> Place:
        """Keep it, with which way it looks if it is `facing` anywhere.

        Raises `SkillFailed` with the reason if it cannot be kept; then nothing changed.
        """
        with self._changing:
            self.check(name)
            place = Place(
                robot=self._robot or "nobody",
                world=self._world,
                name=name,
                x=round(pose.x_m, 3),
                y=round(pose.y_m, 3),
                yaw=round(pose.yaw_rad, 4) if facing else None,
                frame=frame,
            )
            self._change(name, place)
            return place

    def forget(self, name: str) -> None:
        """Keep it no longer. Raises `SkillFailed` with the reason if that cannot be done."""
        with self._changing:
            if name in self.own.fixed:
                raise SkillFailed(because("place_stays", place=_said(name)))
            if name not in self._places:
                raise SkillFailed(because("place_unknown", place=_said(name)))
            self._change(name, None)

    @cached_property
    def _said_for_own(self) -> Mapping[str, str]:
        return names_of(self.own)

    def _change(self, name: str, place: Place | None) -> None:
        known = [one for one in self._places.values() if one.name != name]
        written = {*self._places, name}

        def change(places: Sequence[Place]) -> Sequence[Place]:
            """Keep other robots' places, and write this one's again if they are gone."""
            others = [one for one in places if not (self._mine(one) and one.name in written)]
            return (*others, *known, *((place,) if place else ()))

        if self._store is None:
            self._take(change(tuple(self._places.values())))
            return
        try:
            self._take(self._store.change(change))
        except OSError as error:
            log.error("places_unsaved", file=str(self._store.file), reason=str(error))  # noqa: TRY400 - the reason says it all
            why = error.strerror or str(error)
            raise SkillFailed(because("places_unsaved", why=why)) from None

    def _mine(self, place: Place) -> bool:
        return (place.robot, place.world) == (self._robot or "nobody", self._world)

    def _take(self, places: Sequence[Place]) -> None:
        mine = {one.name: one for one in places if self._mine(one)}
        fit: dict[str, Place] = {}
        for name, one in mine.items():
            known = name in self._places or is_fit(name, self._said_for_own)
            if known and not names_meant(name, {other: other for other in fit}):
                fit[name] = one
        if unused := [one for one in mine if one not in fit]:
            names = ", ".join(map(shorten, unused[:_MOST_TOLD]))
            log.warning("places_unused", world=self._world, count=len(unused), said=Said(names))
        self._places = MappingProxyType(fit)


def _said(name: str) -> str:
    return name.replace("_", " ")
