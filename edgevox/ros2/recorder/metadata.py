"""`metadata.yaml` of rosbag2: the files of a recording, and the topics that are in them."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from edgevox.core.files.state_files import PUBLIC, write_atomically
from edgevox.core.log import get_logger
from edgevox.ros2.contract_rows import QosSpec
from edgevox.ros2.recordings import METADATA, OPEN, file_number

log = get_logger(__name__)

VERSION = 9
"""The version of rosbag2's format in Jazzy."""
_FOR_EVER = {"sec": 9223372036, "nsec": 854775807}


@dataclass(frozen=True)
class TopicInfo:
    """A topic as a file names it."""

    name: str
    type: str
    qos: str
    """The offered qualities of service, as YAML."""
    type_hash: str


@dataclass
class FileInfo:
    """The contents of one file."""

    name: str
    first_ns: int = 0
    last_ns: int = 0
    messages: int = 0
    counts: dict[TopicInfo, int] = field(default_factory=dict)

    def count(self, topic: TopicInfo, first_ns: int, last_ns: int, messages: int = 1) -> None:
        """Add messages."""
        self.first_ns = min(self.first_ns or first_ns, first_ns)
        self.last_ns = max(self.last_ns, last_ns)
        self.messages += messages
        self.counts[topic] = self.counts.get(topic, 0) + messages


class RecordingInfo:
    """The contents of a recording: what `metadata.yaml` tells of it."""

    def __init__(self) -> None:
        self.files: dict[str, FileInfo] = {}
        self._counts: dict[TopicInfo, int] = {}

    def add(self, file: FileInfo) -> None:
        """Add a file, unless it is known."""
        if file.name not in self.files:
            self.files[file.name] = file
            self._count(file.counts.items(), 1)

    def remove(self, name: str) -> None:
        """Forget a file that was added."""
        file = self.files.pop(name, None)
        if file is not None:
            self._count(file.counts.items(), -1)

    def write(self, folder: Path) -> None:
        """Write it, as not finished; it is whole or as it was. Raises `OSError`."""
        text = yaml.safe_dump({"rosbag2_bagfile_information": self._describe()}, sort_keys=False)
        write_atomically(folder / f"{METADATA}{OPEN}", text, PUBLIC)

    @classmethod
    def read(cls, folder: Path) -> "RecordingInfo":
        """What `write` wrote, also of files that were moved away since; empty without that.

        Raises `OSError`.
        """
        made = cls()
        try:
            text = (folder / f"{METADATA}{OPEN}").read_text(encoding="utf-8")
            about = yaml.safe_load(text)["rosbag2_bagfile_information"]
            for one in about["files"]:
                first_ns = int(one["starting_time"]["nanoseconds_since_epoch"])
                last_ns = first_ns + int(one["duration"]["nanoseconds"])
                made.add(FileInfo(one["path"], first_ns, last_ns, int(one["message_count"])))
            counts = {_read(one): int(one["message_count"]) for one in _topics(about)}
        except FileNotFoundError:
            return made
        except (ValueError, TypeError, LookupError, yaml.YAMLError) as error:
            log.warning("recording_metadata_unreadable", folder=str(folder), reason=repr(error))
            return cls()
        made._count(counts.items(), 1)
        return made

    def _count(self, counts: Iterable[tuple[TopicInfo, int]], sign: int) -> None:
        for topic, number in counts:
            self._counts[topic] = self._counts.get(topic, 0) + sign * number

    def _describe(self) -> dict[str, Any]:
        files = sorted(self.files.values(), key=lambda one: file_number(one.name))
        heard = [one for one in files if one.messages]
        first_ns = min((one.first_ns for one in heard), default=0)
        last_ns = max((one.last_ns for one in heard), default=0)
        return {
            "version": VERSION,
            "storage_identifier": "mcap",
            **_span(first_ns, last_ns),
            "message_count": sum(one.messages for one in files),
            "topics_with_message_count": [
                {"topic_metadata": _write(topic), "message_count": number}
                for topic, number in self._counts.items()
                if number
            ],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [one.name for one in files],
            "files": [
                {
                    "path": one.name,
                    **_span(one.first_ns, one.last_ns),
                    "message_count": one.messages,
                }
                for one in files
            ],
            "custom_data": None,
            "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
        }


def qos_yaml(qos: QosSpec) -> str:
    """An offered quality of service, as a channel of an MCAP file names it."""
    told = {
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
    return yaml.safe_dump([told], sort_keys=False)


def _topics(about: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return list(about["topics_with_message_count"])


def _write(topic: TopicInfo) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": yaml.safe_load(topic.qos),
        "type_description_hash": topic.type_hash,
    }


def _read(counted: Mapping[str, Any]) -> TopicInfo:
    told = counted["topic_metadata"]
    qos = yaml.safe_dump(told["offered_qos_profiles"], sort_keys=False)
    return TopicInfo(told["name"], told["type"], qos, told["type_description_hash"])


def _span(first_ns: int, last_ns: int) -> dict[str, Any]:
    return {
        "starting_time": {"nanoseconds_since_epoch": first_ns},
        "duration": {"nanoseconds": last_ns - first_ns},
    }
