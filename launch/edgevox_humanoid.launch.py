"""Start the agent with a humanoid in MuJoCo, chosen by `model_source` or `mjcf`."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

AGENT = str(Path(__file__).with_name("edgevox.launch.py"))


def generate_launch_description() -> LaunchDescription:
    """The agent of edgevox.launch.py, with its arguments, for this robot."""
    robot = {"robot": "robot-humanoid"}
    return LaunchDescription(
        [
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(AGENT), launch_arguments=robot.items()
            )
        ]
    )
