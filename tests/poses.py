"""Poses that property tests try, and when two of them are the same."""

import math

from hypothesis import strategies as st

from edgevox.core.transforms import Pose2D, Pose3D, angle, distance, lift, unit

NEAR_M = st.floats(-100, 100)
TURNS_RAD = st.floats(-math.pi, math.pi)
PARTS = st.floats(-1, 1)
POSES = st.builds(Pose3D, NEAR_M, NEAR_M, NEAR_M, PARTS, PARTS, PARTS, PARTS).map(unit)
FLOOR = st.builds(Pose2D, NEAR_M, NEAR_M, TURNS_RAD)
ON_FLOOR = FLOOR.map(lift)
"""As `FLOOR`, in three dimensions."""


def same(one: Pose3D, other: Pose3D) -> bool:
    return distance(one, other) < 1e-6 and angle(one, other) < 1e-5
