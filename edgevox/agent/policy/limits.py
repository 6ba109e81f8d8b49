"""Limits of a policy: where to, how far, how fast, when. They hold for whatever moves."""

import math
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from edgevox.agent.policy.hours import Interval
from edgevox.agent.policy.part import PolicyPart
from edgevox.agent.policy.policy_context import PolicyContext
from edgevox.agent.policy.targets import distance_in, places_in, plain, point_in
from edgevox.agent.reasons import because
from edgevox.core.reason import NO_REASON, Reason

Names = Annotated[
    tuple[Annotated[str, Field(min_length=1, max_length=64)], ...],
    Field(min_length=1, max_length=200),
]
Metres = Annotated[float, Field(ge=-10_000, le=10_000)]
Fast = Annotated[float, Field(gt=0, le=50)]
AXES = ("x", "y", "z")


class Span(PolicyPart):
    """From a least to a most, in metres; without one of them it has no end there."""

    least: Metres | None = Field(None, alias="min", description="metres; no end without it")
    most: Metres | None = Field(None, alias="max", description="metres; no end without it")

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if self.least is not None and self.most is not None and self.least > self.most:
            raise ValueError("`min` at most as much as `max`")
        return self

    def holds(self, value: float) -> bool:
        """Whether a coordinate is in it, ends included."""
        below = self.least is not None and value < self.least
        return not below and not (self.most is not None and value > self.most)

    def __str__(self) -> str:
        ends = (("from", self.least), ("to", self.most))
        return " ".join(f"{word} {end:g}" for word, end in ends if end is not None)


class Area(PolicyPart):
    """A rectangle of the floor for the goals of drives."""

    frame: Literal["map"] = Field("map", description="the frame that skills' points are in")
    x: Span = Span()
    y: Span = Span()

    def holds(self, point: Sequence[float]) -> bool:
        """Whether a point is in it, edges included."""
        sides = (getattr(self, axis) for axis in AXES[: len(point)])
        return all(side.holds(value) for side, value in zip(sides, point, strict=True))

    def __str__(self) -> str:
        sides = ((axis, str(getattr(self, axis, ""))) for axis in AXES)
        return ", ".join(f"{axis} {side}" for axis, side in sides if side)


class Box(Area):
    """A box for the points that a hand is sent to."""

    z: Span = Span()


class Places(PolicyPart):
    """Where it may go by name; `never` counts before `only`."""

    only: Names | None = Field(None, description="no other place than these")
    never: Names | None = Field(None, description="none of these places")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.only is None and self.never is None:
            raise ValueError("`only` or `never`, with names of places")
        return self

    @property
    def names(self) -> frozenset[str]:
        """All that are named, as they are compared."""
        return frozenset(map(plain, (*(self.only or ()), *(self.never or ()))))

    def permits(self, place: str) -> bool:
        """Whether it may go there."""
        name = plain(place)
        if any(name == plain(one) for one in self.never or ()):
            return False
        return self.only is None or any(name == plain(one) for one in self.only)


class Speed(PolicyPart):
    """How fast it may be steered by velocities."""

    linear_m_s: Fast | None = Field(None, description="metres per second")
    angular_rad_s: Fast | None = Field(None, description="radians per second")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.linear_m_s is None and self.angular_rad_s is None:
            raise ValueError("`linear_m_s` or `angular_rad_s`")
        return self

    def within(self, linear_m_s: float, angular_rad_s: float) -> tuple[float, float]:
        """Both slowed by the same factor, where one is too fast: the way stays the same arc."""
        over = max(
            abs(linear_m_s) / (self.linear_m_s or math.inf),
            abs(angular_rad_s) / (self.angular_rad_s or math.inf),
        )
        return (
            (linear_m_s / over, angular_rad_s / over) if over > 1 else (linear_m_s, angular_rad_s)
        )


class PolicyLimits(PolicyPart):
    """All of them; one that is not given does not limit."""

    places: Places | None = Field(None, description="where it may go")
    distance_m: Annotated[float, Field(gt=0, le=10_000)] | None = Field(
        None, description="how far a walk may be, or the goal of a drive as the crow flies"
    )
    speed: Speed | None = Field(
        None, description="how fast it drives; what is faster is slowed to it"
    )
    goals: Area | None = Field(None, description="where the goals of drives may be")
    hand: Box | None = Field(None, description="where a hand may be sent")
    hours: Annotated[tuple[Interval, ...], Field(min_length=1, max_length=50)] | None = Field(
        None, description="when it may be set in motion; any time without it"
    )

    def closed(self, now: datetime) -> Reason:
        """Why nothing may move now; none if it may."""
        if self.hours is None or any(one.holds(now) for one in self.hours):
            return NO_REASON
        return because("policy_hours", hours=", ".join(map(str, self.hours)))

    def against(self, arguments: Mapping[str, Any], around: PolicyContext) -> Reason:
        """Why a skill may not be called with these arguments; none if it may."""
        places = around.places() if self.places or self.goals or self.distance_m else {}
        named = places_in(arguments, places)
        spots = [places[name] for name in named if name in places]
        point = point_in(arguments)
        return (
            self._off_limits(named, point, around)
            or self._outside([*spots, point] if point else spots)
            or self._too_far(arguments, [*spots, point] if point else spots, around)
        )

    def _off_limits(
        self, named: Sequence[str], point: Sequence[float] | None, around: PolicyContext
    ) -> Reason:
        """By name, and where a point of the floor lies in a place."""
        if self.places is None:
            return NO_REASON
        there = around.place_at(*point) if point and len(point) == 2 else None
        for name in (*named, *((there,) if there else ())):
            if not self.places.permits(name):
                return because("policy_place", place=name.replace("_", " "))
        if self.places.only and point and len(point) == 2 and there is None:
            return because("policy_nowhere")
        return NO_REASON

    def _outside(self, spots: Sequence[Sequence[float]]) -> Reason:
        for spot in spots:
            area = self.goals if len(spot) == 2 else self.hand
            if area and not area.holds(spot):
                return because("policy_area", area=str(area))
        return NO_REASON

    def _too_far(
        self, arguments: Mapping[str, Any], spots: Sequence[Sequence[float]], around: PolicyContext
    ) -> Reason:
        if self.distance_m is None:
            return NO_REASON
        told = distance_in(arguments)
        far = [told] if told is not None else []
        on_the_floor = [spot for spot in spots if len(spot) == 2]
        if on_the_floor:
            here = around.here()
            if here is None:
                return because("policy_lost")
            far += [math.dist(here, spot) for spot in on_the_floor]
        if max(far, default=0.0) > self.distance_m:
            return because("policy_distance", most=f"{self.distance_m:g}")
        return NO_REASON
