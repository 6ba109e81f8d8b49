"""The interface packages that scripts/build_msgs.py built into this environment."""

import os

import rclpy

from edgevox_msgs.action import ExecuteSkill
from edgevox_msgs.msg import AudioData
from tf2_msgs.msg import TFMessage

# What `ros2 topic info --verbose /tf` shows on an installed ROS 2 Jazzy.
TF_MESSAGE_HASH = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"


def test_execute_skill_carries_json_both_ways_and_a_reason() -> None:
    assert ExecuteSkill.Goal.get_fields_and_field_types() == {
        "skill_name": "string",
        "arguments_json": "string",
    }
    assert ExecuteSkill.Result.get_fields_and_field_types() == {
        "ok": "boolean",
        "result_json": "string",
        "error": "string",
    }
    assert ExecuteSkill.Feedback.get_fields_and_field_types() == {"feedback_json": "string"}


def test_sound_has_the_one_field_of_audio_common_msgs() -> None:
    assert AudioData.get_fields_and_field_types() == {"data": "sequence<uint8>"}


def test_the_transform_message_is_the_one_that_other_nodes_know() -> None:
    topic = f"/interfaces_{os.getpid()}"  # other tests run nodes, too
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("interfaces", context=context)
    node.create_publisher(TFMessage, topic, 1)

    (publisher,) = node.get_publishers_info_by_topic(topic)

    assert str(publisher.topic_type_hash) == TF_MESSAGE_HASH
    node.destroy_node()
    context.shutdown()
