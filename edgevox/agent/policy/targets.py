"""Where to and how far: what the arguments of a skill say of it, told by their names.

So skills that nobody here knows are limited, too: `x` and `y` (and `z` for a hand) are a point,
`distance` is metres, `room`, `location`, `place` and `target` are places, as is every text that is
the name of one. What stands within an argument counts as well, such as a list of points.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from edgevox.agent.same_name import name_form

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
