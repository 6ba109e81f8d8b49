"""A robot's memory of places in one world, with forgetting."""

import threading
from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

from edgevox.agent.phrases.name_rules import names_of, word_meant
from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import names_meant
from edgevox.core.errors import shorten
from edgevox.core.log import Said, get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.places.store import MOST_PLACES, Place, PlaceStore, check_new_name, is_fit

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
