"""What was heard and is not yet written: bounded, and what does not fit in is counted."""

import threading
from collections import Counter

from edgevox.core.log import get_logger
from edgevox.ros2.recorder.mcap_file import RecordedMessage

log = get_logger(__name__)

MOST_MESSAGES = 20_000
MOST_BYTES = 64 * 1024 * 1024


class WriteQueue:
    """One thread puts, another takes; neither waits for the other."""

    def __init__(self, most_messages: int = MOST_MESSAGES, most_bytes: int = MOST_BYTES) -> None:
        self._most_messages, self._most_bytes = most_messages, most_bytes
        self._lock = threading.Lock()
        self._messages: list[RecordedMessage] = []
        self._bytes = 0
        self.dropped: Counter[str] = Counter()

    def put(self, message: RecordedMessage) -> None:
        """Take it in, or count it as dropped if there is no room."""
        size = len(message.data)
        with self._lock:
            fits = len(self._messages) < self._most_messages
            if fits and self._bytes + size <= self._most_bytes:
                self._messages.append(message)
                self._bytes += size
                return
        self.drop([message], "the disk is too slow")

    def take(self) -> list[RecordedMessage]:
        """All that is there, oldest first."""
        with self._lock:
            messages, self._messages, self._bytes = self._messages, [], 0
        return messages

    def drop(self, messages: list[RecordedMessage], why: str) -> None:
        """Count them as lost."""
        before = self.dropped.total()
        self.dropped.update(message.topic.name for message in messages)
        if self.dropped.total().bit_length() > before.bit_length():  # a flood leaves a few lines
            log.warning("messages_not_recorded", dropped=self.dropped.total(), reason=why)
