"""Transforms as bytes: the same that rclpy makes of the message."""

from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from edgevox.core.transforms import Pose3D
from edgevox.ros2.interop.tf_encoder import TfEncoder
from edgevox.ros2.messages import transform_msg
from edgevox.ros2.stamps import to_msg
from edgevox.ros2.tf_buffer import FramePose
from tf2_msgs.msg import TFMessage

numbers = st.floats(allow_nan=False, allow_infinity=False)
poses = st.builds(Pose3D, *[numbers] * 7)
names = st.text("abcz_/1é", max_size=20)
frames = st.lists(st.builds(FramePose, names, names, poses), max_size=5)
stamps = st.integers(0, (2**31 - 1) * 10**9)


def said(placed, stamp_ns):
    stamp = to_msg(stamp_ns)
    return TFMessage(transforms=[transform_msg(o.parent, o.child, o.pose, stamp) for o in placed])


@given(frames, stamps)
def test_the_bytes_are_the_message_that_rclpy_makes(placed, stamp_ns):
    encoded = TfEncoder(placed).encode(stamp_ns, [one.pose for one in placed])
    message = said(placed, stamp_ns)
    assert deserialize_message(encoded, TFMessage) == message
    assert len(encoded) == len(serialize_message(message)), "what is between is anything"


@given(frames, st.lists(stamps, min_size=2, max_size=4), st.data())
def test_nothing_of_the_message_before_is_left_in_the_next(placed, many, data):
    encoder = TfEncoder(placed)
    for stamp_ns in many:
        moved = [FramePose(one.parent, one.child, data.draw(poses)) for one in placed]
        encoded = encoder.encode(stamp_ns, [one.pose for one in moved])
        assert deserialize_message(encoded, TFMessage) == said(moved, stamp_ns)
