"""Start an agent with the body that `robot` names.

Imports nothing of edgevox, which may live in another Python environment than `ros2 launch`. A
launch file for one robot includes this one and sets `robot`.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    "robot": "the body, as edgevox-agent calls it",
    "namespace": "namespace of the ROS 2 node",
    "language": "language to hear and speak, ISO 639-1 code",
    "state_hz": "how often robot_state is published, in hertz",
    "world": "world file of a 2D robot, in IR-SIM's YAML format",
    "external_namespace": "robot-external: namespace of the robot's topics, such as /robot1",
    "locations": "robot-external: YAML file of the places that it knows by name",
    "llm": "language model: an id of edgevox-models, a GGUF file, or none",
    "log_level": "least severe log lines to show",
    "config": "TOML file with settings",
    "params_file": "YAML file with ROS 2 parameters",
}
# An empty argument is not handed on, so that EDGEVOX_* variables and `config` hold.
DEFAULTS = {"robot": "robot-apartment"}
FLAGS = {
    "language": "--language",
    "state_hz": "--ros2-state-hz",
    "world": "--world",
    "external_namespace": "--namespace",
    "locations": "--locations",
    "llm": "--llm",
    "log_level": "--log-level",
    "config": "--config",
}


def generate_launch_description() -> LaunchDescription:
    """The arguments, and the agent that they reach."""
    arguments = [
        DeclareLaunchArgument(name, default_value=DEFAULTS.get(name, ""), description=about)
        for name, about in ARGUMENTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=_agent)])


def _agent(context: LaunchContext) -> list[Node]:
    def value(name: str) -> str:
        return str(LaunchConfiguration(name).perform(context))

    flags = [(flag, value(name)) for name, flag in FLAGS.items()]
    return [
        Node(
            package="edgevox",
            executable="edgevox-agent",
            arguments=[
                value("robot"),
                "--text-mode",
                "--ros2",
                *(f"{flag}={given}" for flag, given in flags if given),
            ],
            namespace=value("namespace") or None,
            parameters=[value("params_file")] if value("params_file") else None,
            output="screen",
        )
    ]
