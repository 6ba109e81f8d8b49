"""The skills as a page makes forms of them: their schemas, with the policy's limits in them."""

from collections.abc import Mapping, Sequence
from typing import Any

from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.policy import Guard, PolicyContext, Rule
from edgevox.agent.policy.limits import PolicyLimits
from edgevox.agent.policy.targets import PLACES
from edgevox.agent.skills import STOP, Skill
from edgevox.core.ways import Way


def offered(
    skills: Sequence[Skill], guard: Guard, phrases: Phrasebook, way: Way
) -> list[dict[str, Any]]:
    """Each skill as this way may ask for it, told in the language of the phrasebook."""
    file = guard.look().file
    return [
        {
            "name": one.name,
            "label": phrases.can(one),
            "description": one.description,
            "schema": limited(one.schema, file.limits, guard.around) if one.drives else one.schema,
            "moves": one.drives,
            "lasting": one.lasting,
            "allowed": one.name == STOP or file.rule(way, one.name) is not Rule.DENY,
        }
        for one in skills
    ]


def limited(
    schema: Mapping[str, Any], limits: PolicyLimits, around: PolicyContext
) -> dict[str, Any]:
    """The schema of what is permitted. What it cannot say, the policy refuses when it is asked."""
    fields = schema.get("properties", {})
    return {
        **schema,
        "properties": {name: _field(name, one, limits, around) for name, one in fields.items()},
    }


def _field(
    name: str, field: Mapping[str, Any], limits: PolicyLimits, around: PolicyContext
) -> dict[str, Any]:
    found = dict(field)
    if limits.places and name in PLACES and "enum" in found:
        lasting = limits.model_copy(update={"distance_m": None})
        found["enum"] = [
            word for word in found["enum"] if not lasting.against({name: word}, around)
        ]
    if limits.distance_m and name == "distance":
        found["maximum"] = min(limits.distance_m, found.get("maximum", limits.distance_m))
    area = limits.goals
    if area and name in ("x", "y"):
        span = getattr(area, name)
        found |= {
            key: end
            for key, end in (("minimum", span.least), ("maximum", span.most))
            if end is not None
        }
    return found
