"""Where a world ends: a goal beyond can be refused before anything moves."""

from dataclasses import dataclass

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed


@dataclass(frozen=True, slots=True)
class Bounds:
    """A rectangle of the map frame, edges included, and what it is called. Metres."""

    name: str
    x_min_m: float
    x_max_m: float
    y_min_m: float
    y_max_m: float

    @classmethod
    def around(cls, name: str, furthest_m: float) -> "Bounds":
        """Of a world whose edges nobody knows: this far from the map's origin."""
        return cls(name, -furthest_m, furthest_m, -furthest_m, furthest_m)

    def check(self, x_m: float, y_m: float) -> None:
        """Raise `SkillFailed` with the reason, fit for being said, if a point is not within."""
        if self.x_min_m <= x_m <= self.x_max_m and self.y_min_m <= y_m <= self.y_max_m:
            return
        edges = ("x_min", "x_max", "y_min", "y_max")
        metres = (self.x_min_m, self.x_max_m, self.y_min_m, self.y_max_m)
        values = {name: f"{value:g}" for name, value in zip(edges, metres, strict=True)}
        raise SkillFailed(because("outside", place=self.name.replace("_", " "), **values))
