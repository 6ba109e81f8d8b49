"""How often a reading is what was meant, by the confidence that the judge gave it."""

from collections.abc import Iterable, Iterator
from math import floor
from statistics import fmean

from benchmarks.core.figures import Figure

TABLE = "How far the confidence in a reading can be believed, held out"
GIVEN, RIGHT, COUNTED = "confidence, on average", "what was meant", "readings"
BINS = 10


def calibrated(weighed: Iterable[tuple[float, bool]]) -> Iterator[Figure]:
    """For each tenth of confidence with a reading in it: what was given, and what was right."""
    bins: dict[int, list[tuple[float, bool]]] = {}
    for confidence, right in weighed:
        bins.setdefault(min(BINS - 1, floor(confidence * BINS)), []).append((confidence, right))
    for number in sorted(bins):
        found = bins[number]
        given = fmean(confidence for confidence, _ in found)
        right = fmean(was_right for _, was_right in found)
        for name, column, value, unit in (
            ("given", GIVEN, round(given, 3), ""),
            ("right", RIGHT, round(100 * right, 1), "%"),
            ("count", COUNTED, len(found), ""),
        ):
            yield Figure(
                id=f"calibration.{name}.{number}", table=TABLE, column=column, value=value,
                what=f"{number / BINS:.1f} to {(number + 1) / BINS:.1f}", unit=unit, n=len(found),
            )  # fmt: skip
