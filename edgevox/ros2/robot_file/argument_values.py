"""Which values an argument of a robot file may have; a default has to be one."""

from collections.abc import Collection

from edgevox.ros2.robot_file.step_format import Scalar

_KINDS = {"boolean": "true or false", "text": "a text", "integer": "a whole number"}


def wanted_instead(
    value: Scalar, kind: str, words: Collection[str], low: float | None, high: float | None
) -> str:
    """What an argument of this kind would take instead of a value; empty if it takes it."""
    if kind == "choice":
        return "" if value in words else "one of " + ", ".join(words)
    within = not isinstance(value, bool | str) and (
        (low is None or value >= low) and (high is None or value <= high)
    )
    fits = {
        "boolean": isinstance(value, bool),
        "text": isinstance(value, str),
        "integer": within and isinstance(value, int),
        "number": within,
    }
    if fits[kind]:
        return ""
    bounds = [f"{word} {one:g}" for word, one in (("from", low), ("to", high)) if one is not None]
    return " ".join([_KINDS.get(kind, "a number"), *bounds])
