"""The recorder's node, which receives messages without looking into them."""

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.status import (
    ComponentName,
    Components,
    Finding,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    lives,
    moves,
)
from edgevox.ros2.bridge import DiagnosticsPublisher
from edgevox.ros2.contract import RECORDER_NODE
from edgevox.ros2.node import RosNode
from edgevox.ros2.recorder.disk import Disk, WriteQueue, Writing
from edgevox.ros2.recorder.mcap import RecordedMessage, definition
from edgevox.ros2.recorder.mend import mend_recordings
from edgevox.ros2.recorder.recorded_topics import Recorded, message_class
from edgevox.ros2.recordings import upload_fault
from edgevox.ros2.ticker import Ticker

log = get_logger(__name__)


class Recorder:
    """Records topics from `start` to `close`, and mends what earlier recorders left unfinished.

    A topic whose type is not installed is left out and reported. Raises `RosBridgeFailed` if ROS 2
    does not work, `EdgeVoxError` if the folder cannot be made.
    """

    name = ComponentName.RECORDER

    def __init__(
        self,
        namespace: str,
        topics: Sequence[Recorded],
        disk: Disk,
        ros_args: Sequence[str] = (),
    ) -> None:
        self._inbox = WriteQueue()
        try:
            self._writing = Writing(self._inbox, disk)
        except OSError as error:
            raise EdgeVoxError(f"output: {disk.folder}: {error.strerror or error}") from None
        self._output = disk.folder.parent
        self._closing = threading.Event()
        self._mending = threading.Thread(
            target=mend_recordings,
            args=(disk.folder.parent, self._closing.is_set),
            name="edgevox-mending",
        )
        self.ros = RosNode(namespace, ros_args, name=RECORDER_NODE)
        self._ticker = Ticker("edgevox-recorder-diagnostics")
        self._losing = RecentIncrease()
        self._diagnostics = self._report()
        self.topics = tuple(topic for topic in topics if self._listen(topic))

    def start(self) -> None:
        self._writing.start()
        self._mending.start()
        self.ros.start()
        self._ticker.start()

    def close(self) -> None:
        """Receive nothing more, and write the rest. Who listens learns that it has ended."""
        self._closing.set()
        self._ticker.close()
        if self._diagnostics:
            self._diagnostics.publish()
        self.ros.close()
        self._writing.close()
        if self._mending.is_alive():
            self._mending.join()

    @property
    def checks(self) -> Sequence[HealthCheck]:
        """Its health checks."""
        return (
            HealthCheck("recording", lives(lambda: self._writing.alive)),
            HealthCheck("ros2", moves(lambda: self.ros.stalled_s)),
            HealthCheck("disk", lambda: self.fault, vital=False),
        )

    def status(self) -> Status:
        """Return the current status."""
        upload = upload_fault(self._output, time.time())
        ended = self._closing.is_set()
        findings = [Finding(Level.ERROR, self.fault)] if self.fault else []
        dropped = sum(self.dropped.values())
        if self._losing.grew(dropped):
            text = f"{dropped} messages lost by now: the log has the reason (messages_not_recorded)"
            findings.append(Finding(Level.WARN, text))
        if upload:
            findings.append(Finding(Level.WARN, upload))
        return Status.judged(
            self.name,
            findings,
            well="has ended" if ended else "records",
            ended=ended,
            upload_failed=bool(upload),
            written_messages=self.written,
            dropped_messages=dropped,
            used_bytes=self._writing.room.used_bytes,
            free_bytes=self._writing.room.free_bytes,
        )

    @property
    def fault(self) -> str:
        """The reason why nothing can be written; empty if it can."""
        return self._writing.fault

    @property
    def full(self) -> threading.Event:
        """Set once all its files have the bytes that they may have."""
        return self._writing.full

    @property
    def written(self) -> int:
        """The number of messages on the disk."""
        return self._writing.written

    @property
    def files(self) -> int:
        """The number of files that were begun."""
        return self._writing.bag.files

    @property
    def dropped(self) -> Mapping[str, int]:
        """The number of messages that were lost, by topic."""
        return dict(self._inbox.dropped)

    def _report(self) -> DiagnosticsPublisher | None:
        """Tell its status on /diagnostics. An enclave of an older EdgeVox has no right to."""
        try:
            return DiagnosticsPublisher(self.ros.node, Components(self), self._ticker)
        except RuntimeError as error:
            log.warning("recorder_undiagnosed", reason=str(error))
            return None

    def _listen(self, topic: Recorded) -> bool:
        try:
            kind = message_class(topic.type)
            definition(topic.type)
        except EdgeVoxError as error:
            log.warning("topic_not_recorded", topic=topic.name, reason=str(error))
            return False
        self.ros.node.create_subscription(
            kind, topic.name, self._hearer(topic), topic.listening, raw=True
        )
        return True

    def _hearer(self, topic: Recorded) -> Callable[..., None]:
        def hear(data: bytes, info: Any) -> None:
            now_ns = time.time_ns()
            self._inbox.put(
                RecordedMessage(topic, data, now_ns, info["source_timestamp"] or now_ns)
            )

        return hear
