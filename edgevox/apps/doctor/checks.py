"""All checks, once: the doctor asks them, docs/monitoring.md lists them."""

from edgevox.apps.doctor import (
    console,
    machine,
    model_files,
    network,
    packages,
    process_environment,
    robots,
    ros,
    security,
    sound,
)
from edgevox.apps.doctor.check import Check

_ROS, _HERE = "edgevox.ros2.doctor.probe", "edgevox.apps.doctor"

CHECKS: tuple[Check, ...] = (
    Check("python", "a Python that EdgeVox runs on", machine.probe_python, machine.judge_python),
    Check(
        "processor",
        "cores that this process may use, and what the models' code needs of them",
        machine.probe_processor,
        machine.judge_processor,
    ),
    Check(
        "memory",
        "room for the models, below a container's limit",
        machine.probe_memory,
        machine.judge_memory,
    ),
    Check("disk", "room where EdgeVox writes", machine.probe_disk, machine.judge_disk),
    Check("clock", "set, and synchronised", machine.probe_clock, machine.judge_clock),
    Check(
        "settings",
        "settings that make sense, no misspelled `EDGEVOX_` variable",
        process_environment.probe_settings,
        process_environment.judge_settings,
    ),
    Check(
        "policy",
        "who may ask for what, a line for each way in and each limit of the policy file",
        robots.probe_policy,
        robots.judge_policy,
    ),
    Check(
        "packages",
        "the plug-ins and the packages that bring robots and skills, and whether each loads",
        packages.probe_packages,
        packages.judge_packages,
    ),
    Check(
        "folders",
        "temporary files and ROS 2's logs can be written",
        process_environment.probe_folders,
        process_environment.judge_folders,
    ),
    Check(
        "container",
        "not root in it, if it is one",
        process_environment.probe_container,
        process_environment.judge_container,
    ),
    Check(
        "models",
        "the models that the settings need, every byte of them right",
        model_files.probe_models,
        model_files.judge_models,
    ),
    Check(
        "sound",
        "PortAudio, and the microphone and loudspeaker that are asked for",
        f"{_HERE}.sound:probe_sound",
        sound.judge_sound,
    ),
    Check(
        "echo",
        "the echo canceller loads",
        f"{_HERE}.sound:probe_echo",
        sound.judge_echo,
    ),
    Check(
        "espeak-ng",
        "the voice of last resort speaks",
        f"{_HERE}.sound:probe_espeak",
        sound.judge_espeak,
    ),
    Check(
        "stop words",
        "whether English ones are heard by their sound",
        f"{_HERE}.sound:probe_spotter",
        sound.judge_spotter,
    ),
    Check(
        "ros2",
        "rclpy and the middleware load",
        f"{_ROS}:middleware",
        ros.judge_middleware,
        if_lost="unset RMW_IMPLEMENTATION, or install the middleware that it names",
    ),
    Check(
        "security",
        "which build of ROS 2 this is, whether DDS security is asked for and holds, and until when",
        security.probe_security,
        security.judge_security,
        needs=("ros2",),
    ),
    Check(
        "interfaces",
        "`edgevox_msgs` and `tf2_msgs` are built",
        f"{_ROS}:interfaces",
        ros.judge_interfaces,
        needs=("ros2",),
    ),
    Check(
        "domain",
        "`ROS_DOMAIN_ID` is valid, its ports free of others",
        ros.probe_domain,
        ros.judge_domain,
    ),
    Check(
        "discovery",
        "how other nodes are looked for",
        ros.probe_discovery,
        ros.judge_discovery,
    ),
    Check(
        "round trip",
        "a message goes to a node of another process, and back",
        ros.probe_round_trip,
        ros.judge_round_trip,
        needs=("ros2", "domain"),
    ),
    Check(
        "robot file",
        "each interface that the robot file names is on the graph, with its type and QoS",
        robots.probe_robot_file,
        robots.judge_robot_file,
        needs=("ros2", "domain"),
    ),
    Check(
        "multicast",
        "what is sent to DDS's group is heard, on each interface",
        network.probe_multicast,
        network.judge_multicast,
    ),
    Check(
        "shared memory",
        "`/dev/shm` is large enough, and not full of what dead nodes left",
        network.probe_shared_memory,
        network.judge_shared_memory,
    ),
    Check(
        "console",
        "where the console listens, whom that lets in, and how long its certificate is good",
        console.probe_console,
        console.judge_console,
    ),
    Check("buffers", "of UDP, for pictures", network.probe_buffers, network.judge_buffers),
    Check(
        "gpu",
        "NVIDIA's driver answers, if there is one",
        f"{_HERE}.machine:probe_gpu",
        machine.judge_gpu,
    ),
    Check(
        "egl",
        "OpenGL draws without a display, for cameras of simulated robots",
        f"{_HERE}.machine:probe_egl",
        machine.judge_egl,
    ),
)
