"""Start an agent with the body that `robot` names.

Imports nothing of edgevox, which may live in another Python environment than `ros2 launch`. A
launch file for one robot runs this one and calls `agent_of`, so that --show-args shows its own.
"""

from functools import partial

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    "robot": "the body, as edgevox-agent calls it",
    "agent_namespace": "namespace of the ROS 2 node",
    "language": "language to hear and speak: an ISO 639-1 code, a tag or a locale",
    "state_hz": "publishing rate of robot_state, in hertz",
    "world": "world file of a 2D robot, in IR-SIM's YAML format",
    "model_source": "robot-humanoid: the robot model",
    "mjcf": "robot-humanoid: a robot of your own, as an MJCF file",
    "seed": "random seed of the simulated world",
    "render": "show the robot in a window if there is a display",
    "robot_namespace": "robot-external: namespace of the robot's topics, such as /robot1",
    "robot_file": "robot-external: YAML file that describes the robot: its limits, its"
    " topics, and skills made from its ROS 2 interfaces",
    "locations": "robot-external: YAML file of named places",
    "policy": "YAML file that says who may command what, and within which limits",
    "audio_in": "microphone: a device's name, a WAV file or folder, ros2, or none",
    "audio_out": "loudspeaker: a device's name, a WAV file, ros2, or none",
    "wakeword": "listen only after this wake word, such as 'hey jarvis', or a"
    " microWakeWord .json file; empty: always listen",
    "echo": "the robot's own voice in the microphone: cancel it, or gate it by"
    " level; none if another device cancels it",
    "text_mode": "type instead of speaking; no sound is used",
    "publish_clock": "publish the robot's time on /clock, for nodes with use_sim_time",
    "llm": "language model: an id of edgevox-models, a GGUF file, or none; auto takes Qwen2.5-Coder"
    " 1.5B where it was fetched and 6 GB of memory are free, else 0.5B",
    "log_level": "least severe log lines to show",
    "config": "TOML file with settings",
    "params_file": "YAML file with ROS 2 parameters",
    "namespace": "old name of agent_namespace",
    "external_namespace": "old name of robot_namespace",
}
OLD_NAMES = {"agent_namespace": "namespace", "robot_namespace": "external_namespace"}
# An empty argument is not handed on, so that EDGEVOX_* variables and `config` hold.
DEFAULTS = {"robot": "robot-apartment"}
FLAGS = {
    "language": "--language",
    "state_hz": "--ros2-state-hz",
    "world": "--world",
    "model_source": "--model-source",
    "mjcf": "--mjcf",
    "seed": "--seed",
    "robot_namespace": "--robot-namespace",
    "robot_file": "--robot-file",
    "locations": "--locations",
    "policy": "--policy",
    "audio_in": "--audio-in",
    "audio_out": "--audio-out",
    "wakeword": "--wakeword",
    "echo": "--echo",
    "llm": "--llm",
    "log_level": "--log-level",
    "config": "--config",
}
SWITCHES = {
    "render": "--render",
    "text_mode": "--text-mode",
    "publish_clock": "--publish-clock",
}
TRUE, FALSE = ("true", "1", "yes", "on"), ("false", "0", "no", "off")


def generate_launch_description() -> LaunchDescription:
    """The arguments, and the agent that they reach."""
    return agent_of()


def agent_of(robot: str = "") -> LaunchDescription:
    """The agent of this robot, or of the one that the argument `robot` names."""
    now = {old: new for new, old in OLD_NAMES.items()}
    arguments = [
        DeclareLaunchArgument(name, default_value=DEFAULTS.get(name, ""), description=about)
        for name, about in ARGUMENTS.items()
        if not robot or (name != "robot" and _is_for(robot, ARGUMENTS[now.get(name, name)]))
    ]
    names = {argument.name for argument in arguments}
    return LaunchDescription([*arguments, OpaqueFunction(function=partial(_agent, robot, names))])


def _is_for(robot: str, about: str) -> bool:
    """Whether an argument means something to this robot: one of another robot begins with that."""
    whose, colon, _ = about.partition(":")
    return not colon or not whose.startswith("robot-") or whose == robot


def _agent(robot: str, names: set[str], context: LaunchContext) -> list[Node]:
    def value(name: str) -> str:
        return _given(context, name) if name in names else ""

    flags = [(flag, value(name)) for name, flag in FLAGS.items()]
    switches = [_switch(name, flag, value(name)) for name, flag in SWITCHES.items() if value(name)]
    return [
        Node(
            package="edgevox",
            executable="edgevox-agent",
            arguments=[
                robot or value("robot"),
                "--ros2",
                *switches,
                *(f"{flag}={given}" for flag, given in flags if given),
            ],
            namespace=value("agent_namespace") or None,
            parameters=[value("params_file")] if value("params_file") else None,
            output="screen",
        )
    ]


def _given(context: LaunchContext, name: str) -> str:
    """What an argument was given, by its name or by the one that it had before."""
    old = OLD_NAMES.get(name, name)
    new_value, old_value = (str(LaunchConfiguration(one).perform(context)) for one in (name, old))
    if new_value and old_value and new_value != old_value:
        expected = f"{new_value!r}, as {name} says, or only one"
        raise RuntimeError(f"{old}: got {old_value!r}, expected {expected}")
    return new_value or old_value


def _switch(name: str, flag: str, given: str) -> str:
    if given.lower() in TRUE:
        return flag
    if given.lower() in FALSE:
        return "--no-" + flag.removeprefix("--")
    raise RuntimeError(f"{name}: got {given!r}, expected true or false")
