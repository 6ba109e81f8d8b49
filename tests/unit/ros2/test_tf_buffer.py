"""The buffer of transforms: chains, times, and what no robot's frames can be, held to matrices."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import ON_FLOOR, POSES
from scipy.spatial.transform import RigidTransform, Rotation

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import (
    IDENTITY,
    Pose2D,
    Pose3D,
    angle,
    compose,
    distance,
    lift,
    project,
    rigid,
)
from edgevox.ros2.interop.frames import Frames
from edgevox.ros2.interop.interop import on_map
from edgevox.ros2.tf_buffer import AHEAD_NS, FOR_GOOD, KEPT, MOST_FRAMES, FramePose, TfBuffer

trees = st.lists(st.tuples(st.integers(0, 100), POSES), min_size=1, max_size=8)
"""Frame number n hangs from one of those before it, where this pose is."""
stamps = st.lists(st.integers(1, 10**9), min_size=1, max_size=40, unique=True).map(sorted)


def moved(x_m: float, y_m: float, yaw_rad: float = 0.0) -> Pose3D:
    return lift(Pose2D(x_m, y_m, yaw_rad))


def put(buffer: TfBuffer, parent: str, child: str, pose: Pose3D, stamp_ns: int = 1) -> bool:
    return buffer.put(stamp_ns, FramePose(parent, child, pose))


def matrix(pose: Pose3D) -> np.ndarray:
    rotation = Rotation.from_quat([pose.qx, pose.qy, pose.qz, pose.qw])
    at = [pose.x_m, pose.y_m, pose.z_m]
    return RigidTransform.from_components(at, rotation).as_matrix()


@given(trees, st.data())
def test_where_any_frame_is_in_any_other_is_what_the_matrices_of_the_tree_say(tree, data):
    buffer = TfBuffer()
    in_root = {"frame_0": np.eye(4)}
    for number, (above, pose) in enumerate(tree, start=1):
        parent, child = f"frame_{above % number}", f"frame_{number}"
        assert put(buffer, parent, child, pose, data.draw(st.sampled_from([FOR_GOOD, 7])))
        in_root[child] = in_root[parent] @ matrix(pose)
    target, source = (data.draw(st.sampled_from(sorted(in_root))) for _ in range(2))

    found = buffer.lookup(target, source)

    assert np.allclose(matrix(found), np.linalg.inv(in_root[target]) @ in_root[source], atol=1e-6)


@given(stamps, st.integers(1, 2 * 10**9), st.integers(1, 50))
def test_at_a_stamp_it_is_the_nearest_pose_that_is_kept_and_never_one_out_of_reach(
    past, asked, kept
):
    buffer = TfBuffer(kept)
    for number, stamp_ns in enumerate(past):
        put(buffer, "map", "base_link", Pose3D(float(number)), stamp_ns)
    remembered = past[-kept:]

    if not remembered[0] <= asked <= remembered[-1] + AHEAD_NS:
        with pytest.raises(InvalidValue, match="stamp"):
            buffer.lookup("map", "base_link", asked)
        return
    found = past[round(buffer.lookup("map", "base_link", asked).x_m)]
    assert found in remembered
    assert abs(found - asked) == min(abs(one - asked) for one in remembered)


@given(stamps, ON_FLOOR, ON_FLOOR)
def test_links_of_one_moment_are_never_mixed_with_those_of_another(past, one, other):
    buffer = TfBuffer()
    for stamp_ns in past:
        to_odom, in_odom = (one, other) if stamp_ns % 2 else (other, one)
        put_both = FramePose("map", "odom", to_odom), FramePose("odom", "base_link", in_odom)
        buffer.put(stamp_ns, *put_both)
    for stamp_ns in past:
        to_odom, in_odom = (one, other) if stamp_ns % 2 else (other, one)
        assert buffer.lookup("map", "base_link", stamp_ns) == compose(to_odom, in_odom)


def test_a_chain_is_followed_to_the_map() -> None:
    buffer = TfBuffer()
    put(buffer, "map", "odom", moved(3, -2, math.pi / 2))
    put(buffer, "odom", "base_link", moved(1, 0))

    pose = project(buffer.lookup("map", "base_link"))

    assert (pose.x_m, pose.y_m) == pytest.approx((3, -1))
    assert pose.yaw_rad == pytest.approx(math.pi / 2)


def test_frames_that_hang_beside_each_other_are_joined_by_what_they_hang_from() -> None:
    buffer = TfBuffer()
    put(buffer, "base_footprint", "base_link", moved(0.1, 0))
    put(buffer, "base_footprint", "laser", moved(0.3, 0.2))

    pose = project(buffer.lookup("base_link", "laser"))

    assert (pose.x_m, pose.y_m) == pytest.approx((0.2, 0.2))


@pytest.mark.parametrize(
    ("links", "start", "found"),
    [
        ([("map", "odom")], "odom", "map"),
        ([("/map", "/odom")], "odom", "map"),
        ([("robot1/map", "robot1/odom")], "robot1/odom", "robot1/map"),
        ([("map", "robot1/odom")], "robot1/odom", "map"),
        ([("earth", "map"), ("map", "odom")], "odom", "map"),
        ([("odom", "base_link")], "base_link", None),
        ([("odom", "map")], "odom", None),
        ([], "map", "map"),
    ],
)
def test_the_map_is_found_above_the_odometry(links, start, found) -> None:
    buffer = TfBuffer()
    for parent, child in links:
        put(buffer, parent, child, moved(1, 1))

    assert buffer.map_above(start) == found


def test_frames_that_nothing_joins_have_no_transform() -> None:
    buffer = TfBuffer()
    put(buffer, "map", "odom", moved(1, 1))

    assert buffer.lookup("map", "base_link") is None
    assert buffer.lookup("elsewhere", "odom") is None


def test_a_loop_of_transforms_ends() -> None:
    buffer = TfBuffer()
    put(buffer, "a", "b", moved(1, 0))
    put(buffer, "b", "a", moved(1, 0))

    assert buffer.map_above("a") is None
    assert buffer.lookup("map", "a") is None


@pytest.mark.parametrize(
    ("parent", "child", "transform"),
    [
        ("map", "map", moved(1, 1)),
        ("", "odom", moved(1, 1)),
        ("map", "odom", moved(math.nan, 1)),
        ("map", "odom", moved(math.inf, 1)),
        ("map", "odom", moved(1e300, 1)),
        ("map", "odom", moved(1, -1e9)),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 0, 0))),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 0, 3))),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 1e300, 1e300))),
    ],
)
def test_what_cannot_be_a_transform_is_not_taken(parent, child, transform) -> None:
    buffer = TfBuffer()

    assert not put(buffer, parent, child, transform)
    assert buffer.lookup("map", "odom") is None


def test_the_newest_transform_counts() -> None:
    buffer = TfBuffer()
    put(buffer, "map", "odom", moved(1, 1))
    put(buffer, "map", "odom", moved(2, 2))

    assert project(buffer.lookup("map", "odom")).x_m == pytest.approx(2)


@given(ON_FLOOR, ON_FLOOR)
def test_there_and_back_is_nowhere(one, other) -> None:
    buffer = TfBuffer()
    put(buffer, "map", "odom", one)
    put(buffer, "odom", "base_link", other)

    there = buffer.lookup("map", "base_link")
    back = buffer.lookup("base_link", "map")

    nowhere = compose(there, back)
    assert distance(nowhere, IDENTITY) < 1e-6
    assert angle(nowhere, IDENTITY) < 1e-6


def test_a_frame_that_never_moves_is_found_at_every_stamp_that_its_parent_is():
    buffer = TfBuffer()
    put(buffer, "base_link", "lidar_link", moved(0.2, 0), FOR_GOOD)
    put(buffer, "map", "base_link", moved(1, 0), 1000)
    put(buffer, "map", "base_link", moved(2, 0), 2000)

    assert buffer.lookup("map", "lidar_link", 1000).x_m == pytest.approx(1.2)
    assert buffer.lookup("map", "lidar_link", 2000).x_m == pytest.approx(2.2)
    assert buffer.lookup("base_link", "lidar_link", 10**18).x_m == pytest.approx(0.2)


def test_a_frame_that_is_hung_elsewhere_is_found_there_and_before_that_where_it_was():
    buffer = TfBuffer()
    put(buffer, "table", "cup", moved(1, 0), 1000)
    put(buffer, "hand", "cup", moved(0, 1), 2000)

    assert buffer.lookup("table", "cup", 1000).x_m == 1
    assert buffer.lookup("hand", "cup", 2000).y_m == 1
    assert buffer.lookup("table", "cup") is None


def test_time_that_is_set_back_forgets_what_is_later():
    buffer = TfBuffer()
    put(buffer, "map", "base_link", Pose3D(5.0), 5000)
    put(buffer, "map", "base_link", Pose3D(1.0), 1000)

    assert buffer.lookup("map", "base_link", 1000).x_m == 1.0
    assert buffer.lookup("map", "base_link", 5000).x_m == 1.0


def test_no_flood_of_frames_is_remembered_and_those_that_are_known_move_on():
    buffer = TfBuffer(kept=1)
    assert all(put(buffer, "map", f"frame_{number}", IDENTITY) for number in range(MOST_FRAMES))

    assert not put(buffer, "map", "one_more", IDENTITY)
    assert put(buffer, "map", "frame_7", Pose3D(7.0))
    assert len(buffer.frames) == MOST_FRAMES
    assert buffer.lookup("map", "frame_7").x_m == 7.0


def test_ten_seconds_at_the_rate_of_tf_are_remembered():
    buffer = TfBuffer()
    for number in range(KEPT + 100):
        put(buffer, "map", "base_link", Pose3D(float(number)), (number + 1) * 1000)

    assert buffer.lookup("map", "base_link", 101_000).x_m == 100
    with pytest.raises(InvalidValue, match="stamp"):
        buffer.lookup("map", "base_link", 100_000)


@pytest.mark.parametrize("said", ["base_link", "robot1/base_link"])
def test_a_peer_may_say_a_frame_of_the_robot_with_its_prefix_or_without(said):
    frames, buffer = Frames(prefix="robot1/"), TfBuffer()
    put(buffer, frames.map, frames.base, Pose3D(3.0))

    assert on_map(buffer, frames, said, 0).x_m == 3.0


def test_before_anything_is_known_only_the_map_is():
    frames, buffer = Frames(), TfBuffer()

    assert on_map(buffer, frames, "map", 5) == IDENTITY
    with pytest.raises(InvalidValue, match="one of map"):
        on_map(buffer, frames, "base_link", 5)


def test_who_asks_for_a_frame_that_is_none_is_told_those_that_move_first():
    frames, buffer = Frames(), TfBuffer()
    put(buffer, frames.base, frames.lidar, IDENTITY, FOR_GOOD)
    put(buffer, frames.map, frames.base, IDENTITY)

    with pytest.raises(InvalidValue, match="one of map, base_link, lidar_link"):
        on_map(buffer, frames, "moon", 0)
