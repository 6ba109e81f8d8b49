"""All checks, once: the doctor asks them, `--help` says what they are."""

from edgevox.apps.doctor import (
    console,
    machine,
    robots,
    ros,
    servers,
    sound,
)
from edgevox.apps.doctor.check import Check

_ROS, _HERE = "edgevox.ros2.doctor", "edgevox.apps.doctor"

CHECKS: tuple[Check, ...] = (
    Check("python", "this Python version runs EdgeVox", machine.probe_python, machine.judge_python),
    Check(
        "processor",
        "there are enough cores, with the instructions that the models need",
        machine.probe_processor,
        machine.judge_processor,
    ),
    Check(
        "memory",
        "the models fit into memory, within a container's limit",
        machine.probe_memory,
        machine.judge_memory,
    ),
    Check(
        "disk", "there is free space where EdgeVox writes", machine.probe_disk, machine.judge_disk
    ),
    Check("clock", "the clock is set and synchronised", machine.probe_clock, machine.judge_clock),
    Check(
        "settings",
        "the settings are valid, and no `EDGEVOX_` variable is misspelled",
        machine.probe_settings,
        machine.judge_settings,
    ),
    Check(
        "policy",
        "the policy file is valid; it prints a line for each way in and each limit",
        robots.probe_policy,
        robots.judge_policy,
    ),
    Check(
        "packages",
        "every plug-in and every package with robots or skills loads",
        robots.probe_packages,
        robots.judge_packages,
    ),
    Check(
        "folders",
        "EdgeVox can write temporary files and ROS 2's logs",
        machine.probe_folders,
        machine.judge_folders,
    ),
    Check(
        "container",
        "in a container, EdgeVox does not run as root",
        machine.probe_container,
        machine.judge_container,
    ),
    Check(
        "models",
        "the models that the settings need are here and undamaged",
        machine.probe_models,
        machine.judge_models,
    ),
    Check(
        "running",
        "the robot that runs here, by `health_port`, is well: what its `/diagnostics` say",
        machine.probe_running,
        machine.judge_running,
    ),
    Check(
        "servers",
        "the servers of `llm_endpoint`, `stt_endpoint` and `tts_endpoint` answer, and have what is"
        " asked of them",
        servers.probe_servers,
        servers.judge_servers,
    ),
    Check(
        "sound",
        "PortAudio, and the microphone and loudspeaker of the settings, are here",
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
        "the model that detects English stop words by their sound is here",
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
        "DDS security, if it is on, works; it prints the build of ROS 2 and the expiry date",
        ros.probe_security,
        ros.judge_security,
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
        "`ROS_DOMAIN_ID` is valid, and other programs do not get its ports",
        ros.probe_domain,
        ros.judge_domain,
    ),
    Check(
        "discovery",
        "the variables for discovery are valid; it prints how nodes find each other",
        ros.probe_discovery,
        ros.judge_discovery,
    ),
    Check(
        "round trip",
        "a message reaches a node of another process and comes back",
        ros.probe_round_trip,
        ros.judge_round_trip,
        needs=("ros2", "domain"),
    ),
    Check(
        "robot file",
        "every interface of the robot file, or the robot of `robot_namespace`, is on the graph,"
        " with its type and QoS",
        robots.probe_robot_file,
        robots.judge_robot_file,
        needs=("ros2", "domain"),
    ),
    Check(
        "multicast",
        "messages to the multicast group of DDS arrive, on each interface",
        ros.probe_multicast,
        ros.judge_multicast,
    ),
    Check(
        "shared memory",
        "`/dev/shm` is large enough and not full of leftovers of dead nodes",
        ros.probe_shared_memory,
        ros.judge_shared_memory,
    ),
    Check(
        "console",
        "the console can listen on its address, is encrypted, and its certificate is valid",
        console.probe_console,
        console.judge_console,
    ),
    Check(
        "buffers",
        "UDP buffers are large enough for pictures",
        ros.probe_buffers,
        ros.judge_buffers,
    ),
    Check(
        "gpu",
        "NVIDIA's driver answers, if it is installed",
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
