"""Packages of interfaces: ours, built into this environment, and a robot's that are built here."""

import os
import shutil
import subprocess
import sys

import pytest
import rclpy

from edgevox.apps.edgevox import main
from edgevox.ros2.interface_packages import SETUP
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


@pytest.mark.long
def test_an_archive_is_built_and_a_shell_that_sources_it_has_its_types(tmp_path, capsys):
    for name, text in (
        ("lamp_msgs/msg/Lamp.msg", "uint8 OFF=0\nuint8 ON=1\nuint8 state\n"),
        ("room_msgs/srv/Light.srv", "lamp_msgs/Lamp lamp\n---\nbool ok\n"),
    ):
        file = tmp_path / "src" / name
        file.parent.mkdir(parents=True)
        file.write_text(text)
    archive = shutil.make_archive(str(tmp_path / "robot"), "gztar", tmp_path / "src")
    to = tmp_path / "built"
    assert main(["interfaces", archive, "--to", str(to)]) == 0
    said = capsys.readouterr().out
    assert said.index("built lamp_msgs: Lamp") < said.index("built room_msgs: Light")
    assert main(["interfaces", archive, "--to", str(to)]) == 0
    assert "room_msgs is up to date" in capsys.readouterr().out

    program = (
        "import rclpy; from lamp_msgs.msg import Lamp; from room_msgs.srv import Light;"
        "rclpy.init(); rclpy.create_node('room').create_client(Light, 'light');"
        "print(Light.Request(lamp=Lamp(state=Lamp.ON)))"
    )
    shell = f'source {to / SETUP} && exec {sys.executable} -c "$0"'
    done = subprocess.run(
        ["bash", "-euc", shell, program], capture_output=True, text=True, check=False
    )
    assert "lamp_msgs.msg.Lamp(state=1)" in done.stdout, done.stderr
