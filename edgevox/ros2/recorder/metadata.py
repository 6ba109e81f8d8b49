"""`metadata.yaml`, which tells rosbag2 of the files of a recording."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from edgevox.core.atomic_file import PUBLIC, write_atomically
from edgevox.ros2.contract_rows import QosSpec
from edgevox.ros2.recorder.definitions import type_hash
from edgevox.ros2.recorder.recorded_topics import Recorded

NAME = "metadata.yaml"
VERSION = 9
"""Of rosbag2's format; Jazzy's."""
_FOR_EVER = {"sec": 9223372036, "nsec": 854775807}


@dataclass
class FileInfo:
    """What one file holds."""

    name: str
    first_ns: int = 0
    last_ns: int = 0
    counts: dict[Recorded, int] = field(default_factory=dict)

    @property
    def messages(self) -> int:
        """How many there are in it."""
        return sum(self.counts.values())

    def count(self, topic: Recorded, when_ns: int) -> None:
        """One more message."""
        self.first_ns = min(self.first_ns or when_ns, when_ns)
        self.last_ns = max(self.last_ns, when_ns)
        self.counts[topic] = self.counts.get(topic, 0) + 1


def qos_yaml(qos: QosSpec) -> str:
    """An offered quality of service, as a channel of an MCAP file names it."""
    return yaml.safe_dump([_qos(qos)], sort_keys=False)


def write_metadata(folder: Path, files: Sequence[FileInfo]) -> None:
    """Write it for these finished files; it is whole or as it was. Raises `OSError`."""
    text = yaml.safe_dump({"rosbag2_bagfile_information": _describe(files)}, sort_keys=False)
    write_atomically(folder / NAME, text, PUBLIC)


def _describe(files: Sequence[FileInfo]) -> dict[str, Any]:
    heard = [one for one in files if one.messages]
    first_ns = min((one.first_ns for one in heard), default=0)
    last_ns = max((one.last_ns for one in heard), default=0)
    counts: dict[Recorded, int] = {}
    for one in files:
        for topic, number in one.counts.items():
            counts[topic] = counts.get(topic, 0) + number
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        **_span(first_ns, last_ns),
        "message_count": sum(counts.values()),
        "topics_with_message_count": [
            {"topic_metadata": _topic(topic), "message_count": number}
            for topic, number in counts.items()
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [one.name for one in files],
        "files": [
            {"path": one.name, **_span(one.first_ns, one.last_ns), "message_count": one.messages}
            for one in files
        ],
        "custom_data": None,
        "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
    }


def _span(first_ns: int, last_ns: int) -> dict[str, Any]:
    return {
        "starting_time": {"nanoseconds_since_epoch": first_ns},
        "duration": {"nanoseconds": last_ns - first_ns},
    }


def _topic(topic: Recorded) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": [_qos(topic.qos)],
        "type_description_hash": type_hash(topic.type),
    }


def _qos(qos: QosSpec) -> dict[str, Any]:
    return {
        "history": "keep_last",
        "depth": qos.depth,
        "reliability": "reliable" if qos.reliable else "best_effort",
        "durability": "transient_local" if qos.transient_local else "volatile",
        "deadline": dict(_FOR_EVER),
        "lifespan": dict(_FOR_EVER),
        "liveliness": "automatic",
        "liveliness_lease_duration": dict(_FOR_EVER),
        "avoid_ros_namespace_conventions": False,
    }
