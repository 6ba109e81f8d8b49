"""Where to and how far: what the arguments of a skill say of it, told by their names.

So skills that nobody here knows are limited, too: `x` and `y` (and `z` for a hand) are a point,
`distance` is metres, `room`, `location`, `place` and `target` are places, as is every text that is
the name of one.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

PLACES = ("room", "location", "place", "target")


def plain(name: str) -> str:
    """A name as it is compared: without case, underscores as spaces."""
    return " ".join(name.casefold().replace("_", " ").split())


def places_in(arguments: Mapping[str, Any], known: Collection[str]) -> tuple[str, ...]:
    """The places that are named; `known` are those of the robot, whose spelling is kept."""
    spelled = {plain(name): name for name in known}
    return tuple(
        spelled.get(plain(text), text)
        for name, value in arguments.items()
        for text in _texts(value)
        if name in PLACES or plain(text) in spelled
    )


def point_in(arguments: Mapping[str, Any]) -> tuple[float, ...] | None:
    """The point that is named, if any: on the floor, or in space."""
    x, y, z = (_number(arguments.get(axis)) for axis in ("x", "y", "z"))
    if x is None or y is None:
        return None
    return (x, y) if z is None else (x, y, z)


def distance_in(arguments: Mapping[str, Any]) -> float | None:
    """How far it is to go, in metres, if that is said."""
    metres = _number(arguments.get("distance"))
    return None if metres is None else abs(metres)


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | tuple):
        yield from (one for one in value if isinstance(one, str))


def _number(value: Any) -> float | None:
    fits = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if fits else None
