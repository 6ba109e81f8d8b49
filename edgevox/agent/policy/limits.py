"""Limits of a policy: where to, how far, how fast, when. They hold for whatever moves.

Where to and how far: what the arguments of a skill say of it, told by their names.

The same limits apply to the skills of packages: `x` and `y` (and `z` for a hand) are a point,
`distance` is metres, `room`, `location`, `place` and `target` are places, as is every text that is
the name of one. What stands within an argument counts as well, such as a list of points.

Hours of the week, by the clock on the wall.

What all parts of a policy file have in common.

What a policy must know of the robot to judge a goal.
"""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import is_same_name, name_form
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.transforms import Pose2D

PLACES = ("room", "location", "place", "target")


def places_in(arguments: Mapping[str, Any], known: Collection[str]) -> tuple[str, ...]:
    """The places that are named; `known` are those of the robot, whose spelling is kept."""
    spelled = {name_form(name): name for name in known}
    return tuple(
        spelled.get(name_form(text), text)
        for name, value in _each(arguments)
        for text in _texts(value)
        if name in PLACES or name_form(text) in spelled
    )


def points_in(arguments: Mapping[str, Any]) -> tuple[tuple[float, ...], ...]:
    """The points that are named: on the floor, or in space."""
    found = (_point(part) for part in _parts(arguments))
    return tuple(point for point in found if point)


def distance_in(arguments: Mapping[str, Any]) -> float | None:
    """How far it is to go, in metres, if that is said; back where it is less than nothing."""
    return _number(arguments.get("distance"))


def _point(part: Mapping[str, Any]) -> tuple[float, ...] | None:
    x, y, z = (_number(part.get(axis)) for axis in ("x", "y", "z"))
    if x is None or y is None:
        return None
    return (x, y) if z is None else (x, y, z)


def _parts(value: Any) -> Iterator[Mapping[str, Any]]:
    """The arguments, and what stands in them: a list of points, say."""
    if isinstance(value, Mapping):
        yield value
    inner = value.values() if isinstance(value, Mapping) else value
    if isinstance(inner, Collection) and not isinstance(inner, str | bytes):
        for one in inner:
            yield from _parts(one)


def _each(arguments: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for part in _parts(arguments):
        yield from part.items()


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | tuple):
        yield from (one for one in value if isinstance(one, str))


def _number(value: Any) -> float | None:
    fits = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if fits else None


class PolicyPart(BaseModel):
    """A mapping of the file: no key that nobody knows, no number that is none."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Day = Literal["mon", "tue", "wed", "thu", "fri", "sat", "sun"]
DAYS: tuple[Day, ...] = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
MINUTES = 24 * 60
EXPECTED = "a time of day in quotes such as '07:30', from '00:00' to '24:00'"
"""Without quotes YAML makes a number of 19:30, which looks like one that somebody wrote."""


def _minutes(value: Any) -> int:
    """Minutes since midnight."""
    hours, colon, minutes = value.partition(":") if isinstance(value, str) else ("", "", "")
    if colon and all(len(one) == 2 and one.isascii() and one.isdigit() for one in (hours, minutes)):
        total = int(hours) * 60 + int(minutes)
        if int(minutes) < 60 and total <= MINUTES:
            return total
    raise ValueError(EXPECTED)


TimeOfDay = Annotated[
    int,
    BeforeValidator(
        _minutes,
        json_schema_input_type=Annotated[str, Field(pattern="^([01][0-9]|2[0-4]):[0-5][0-9]$")],
    ),
]


class Interval(PolicyPart):
    """Hours of a day. Hours that cross midnight belong to the day on which they begin."""

    begin: TimeOfDay = Field(alias="from", description="local time of the machine, HH:MM")
    end: TimeOfDay = Field(alias="to", description="local time; before `from`: on the next day")
    days: Annotated[tuple[Day, ...], Field(min_length=1, max_length=7)] = Field(
        DAYS, description="the days on which it begins; default: every day"
    )

    @model_validator(mode="after")
    def _takes_time(self) -> Self:
        if self.begin % MINUTES == self.end % MINUTES and (self.begin, self.end) != (0, MINUTES):
            raise ValueError("`to` another time than `from`; 00:00 to 24:00 is a whole day")
        return self

    def holds(self, now: datetime) -> bool:
        """Whether it is that time."""
        minute = now.hour * 60 + now.minute
        today, yesterday = DAYS[now.weekday()], DAYS[now.weekday() - 1]
        if self.begin < self.end:
            return today in self.days and self.begin <= minute < self.end
        tonight = today in self.days and minute >= self.begin
        return tonight or (yesterday in self.days and minute < self.end)

    def __str__(self) -> str:
        days = "" if set(self.days) == set(DAYS) else f" ({', '.join(self.days)})"
        return f"{_clock(self.begin)}-{_clock(self.end)}{days}"


def _clock(minutes: int) -> str:
    return f"{minutes // 60:02}:{minutes % 60:02}"


Spot = tuple[float, float]


def _nowhere(_x_m: float, _y_m: float) -> str | None:
    return None


def _unknown() -> Pose2D | None:
    return None


def _meant(_name: str) -> str | None:
    return None


@dataclass(frozen=True, slots=True)
class PolicyContext:
    """The robot's places and position, asked for at each goal; metres, map frame.

    `places` are points of the robot's map by name, `taught` those that it was told the names of.
    `place_at` says in which place of the map a point is, `here` is where the robot is, None while
    nobody knows. `place_meant` gives the place of the map that a name stands for in any language.
    All are quick.
    """

    places: Callable[[], Mapping[str, Spot]] = field(default=dict)
    place_at: Callable[[float, float], str | None] = _nowhere
    here: Callable[[], Pose2D | None] = _unknown
    taught: Callable[[], Mapping[str, Spot]] = field(default=dict)
    place_meant: Callable[[str], str | None] = _meant

    @property
    def names(self) -> Collection[str]:
        """All names that it goes by."""
        return (*self.places(), *self.taught())


Names = Annotated[
    tuple[Annotated[str, Field(min_length=1, max_length=64)], ...],
    Field(min_length=1, max_length=200),
]
Metres = Annotated[float, Field(ge=-10_000, le=10_000)]
Fast = Annotated[float, Field(gt=0, le=50)]
AXES = ("x", "y", "z")
_STEP_M, _MOST_STEPS = 0.25, 400


class Span(PolicyPart):
    """A range in metres; without a lower or an upper end, that side has no limit."""

    least: Metres | None = Field(None, alias="min", description="metres; default: no limit")
    most: Metres | None = Field(None, alias="max", description="metres; default: no limit")

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

    frame: Literal["map"] = Field("map", description="the frame of the skills' points")
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
    """A box for the target points of a hand."""

    z: Span = Span()


class Places(PolicyPart):
    """The places that a robot may go to; `never` takes precedence over `only`."""

    only: Names | None = Field(None, description="only these places are allowed")
    never: Names | None = Field(None, description="these places are forbidden")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.only is None and self.never is None:
            raise ValueError("`only` or `never`, with names of places")
        return self

    @property
    def names(self) -> frozenset[str]:
        """All that are named, as they are written."""
        return frozenset((*(self.only or ()), *(self.never or ())))

    def forbids(self, place: str, around: PolicyContext) -> bool:
        """Whether `never` names it."""
        return _named(place, self.never or (), around)

    def permits(self, place: str, around: PolicyContext) -> bool:
        """Whether it may go there."""
        if self.forbids(place, around):
            return False
        return self.only is None or _named(place, self.only, around)


def _named(place: str, names: Sequence[str], around: PolicyContext) -> bool:
    """Whether one of these names, as somebody wrote them, is that of the place."""
    known = around.place_meant(place) or place
    meant = ((one, around.place_meant(one)) for one in names)
    return any(own == known if own else is_same_name(one, known) for one, own in meant)


class Speed(PolicyPart):
    """Speed limits for velocity commands."""

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
    """All limits; a missing one does not limit."""

    places: Places | None = Field(None, description="the places it may go to")
    distance_m: Annotated[float, Field(gt=0, le=10_000)] | None = Field(
        None, description="longest walk, or largest straight distance to the goal of a drive"
    )
    speed: Speed | None = Field(
        None, description="highest speed; faster drives are slowed down to it"
    )
    goals: Area | None = Field(None, description="area for the goals of drives")
    hand: Box | None = Field(None, description="volume for the goals of a hand")
    hours: Annotated[tuple[Interval, ...], Field(min_length=1, max_length=50)] | None = Field(
        None, description="times at which motion may start; default: any time"
    )

    def closed(self, now: datetime) -> Reason:
        """Why nothing may move now; none if it may."""
        if self.hours is None or any(one.holds(now) for one in self.hours):
            return NO_REASON
        return because("policy_hours", hours=", ".join(map(str, self.hours)))

    def against(
        self, arguments: Mapping[str, Any], around: PolicyContext, towards_rad: float = 0.0
    ) -> Reason:
        """Why a skill may not be called with these arguments; none if it may.

        A goal is judged by where it is: a place that was taught is a point as any other. So is the
        end of a straight way of some distance, `towards_rad` from where the robot looks.
        """
        if not (self.places or self.goals or self.hand or self.distance_m):
            return NO_REASON
        own, taught = around.places(), around.taught()
        named = places_in(arguments, (*own, *taught))
        points = [*points_in(arguments), *(taught[name] for name in named if name in taught)]
        goals = [*(own[name] for name in named if name in own), *points]
        straight = self._straight(arguments, goals, around, towards_rad)
        if straight is None:
            return because("policy_lost")
        floor = [point for point in points if len(point) == 2]
        return (
            self._off_limits(named, taught, around)
            or self._in_place(floor, around)
            or self._passing(straight, around)
            or self._outside([*goals, *straight[-1:]])
            or self._too_far(arguments, goals, around)
        )

    def _off_limits(
        self, named: Sequence[str], taught: Collection[str], around: PolicyContext
    ) -> Reason:
        """By name; what a place is called that was taught permits nothing."""
        if self.places is None:
            return NO_REASON
        for name in named:
            own = name not in taught
            if self.places.forbids(name, around) or (own and not self.places.permits(name, around)):
                return _there(name)
        return NO_REASON

    def _in_place(self, points: Sequence[Sequence[float]], around: PolicyContext) -> Reason:
        """By the place of the map that a point of the floor lies in."""
        if self.places is None:
            return NO_REASON
        for point in points:
            there = around.place_at(point[0], point[1])
            if there is None and self.places.only:
                return because("policy_nowhere")
            if there is not None and not self.places.permits(there, around):
                return _there(there)
        return NO_REASON

    def _passing(self, straight: Sequence[Sequence[float]], around: PolicyContext) -> Reason:
        """A straight way may cross no place of `never`, and end where it is permitted."""
        if self.places is None:
            return NO_REASON
        for point in straight:
            there = around.place_at(point[0], point[1])
            if there is not None and self.places.forbids(there, around):
                return _there(there)
        return self._in_place(straight[-1:], around) if around.places() else NO_REASON

    def _straight(
        self,
        arguments: Mapping[str, Any],
        goals: Sequence[Sequence[float]],
        around: PolicyContext,
        towards_rad: float,
    ) -> Sequence[tuple[float, float]] | None:
        """The points of a way that is told by its length alone, None while nobody knows them.

        Of the place that the robot stands in none counts: it may leave it.
        """
        told = distance_in(arguments)
        if told is None or goals or not (self.goals or (self.places and around.places())):
            return ()
        here = around.here()
        return None if here is None else _leaving(_along(here, told, towards_rad), here, around)

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
        far = [abs(told)] if told is not None else []
        on_the_floor = [spot for spot in spots if len(spot) == 2]
        if on_the_floor:
            here = around.here()
            if here is None:
                return because("policy_lost")
            far += [math.dist((here.x_m, here.y_m), spot) for spot in on_the_floor]
        if max(far, default=0.0) > self.distance_m:
            return because("policy_distance", most=f"{self.distance_m:g}")
        return NO_REASON


def _there(place: str) -> Reason:
    return because("policy_place", place=place.replace("_", " "))


def _along(here: Pose2D, distance_m: float, towards_rad: float) -> list[tuple[float, float]]:
    """Points of a straight way, at most a quarter of a metre apart, its end last."""
    steps = min(max(1, math.ceil(abs(distance_m) / _STEP_M)), _MOST_STEPS)
    yaw = here.yaw_rad + towards_rad
    ahead = [distance_m * step / steps for step in range(1, steps + 1)]
    return [(here.x_m + one * math.cos(yaw), here.y_m + one * math.sin(yaw)) for one in ahead]


def _leaving(
    way: Sequence[tuple[float, float]], here: Pose2D, around: PolicyContext
) -> Sequence[tuple[float, float]]:
    """The way from where it leaves the place in which the robot stands; its end always counts."""
    start = around.place_at(here.x_m, here.y_m)
    out = next((n for n, one in enumerate(way) if around.place_at(*one) != start), len(way) - 1)
    return way[out:] if start is not None else way
