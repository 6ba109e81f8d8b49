"""Start the agent with a Franka Panda at a table, in MuJoCo."""

import runpy
from pathlib import Path

from launch import LaunchDescription

AGENT = str(Path(__file__).with_name("edgevox.launch.py"))


def generate_launch_description() -> LaunchDescription:
    """The agent of edgevox.launch.py, with the arguments that this robot has."""
    description: LaunchDescription = runpy.run_path(AGENT)["agent_of"]("robot-panda")
    return description
