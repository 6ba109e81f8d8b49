"""The disk of the recorder: its room, and the thread that writes messages and survives a full one.

`Disk` says how much room recordings have, and which files go for others. `WriteQueue` holds the
unwritten messages: bounded, with a count of those that do not fit in.
"""

import errno
import shutil
import threading
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.files.user_file import size_bytes
from edgevox.core.log import get_logger
from edgevox.ros2.recorder.mcap import Bag, RecordedMessage
from edgevox.ros2.recordings import (
    WhenFull,
    finished,
    folders,
    held,
    opened,
    removable,
    remove,
    used_bytes,
)

log = get_logger(__name__)

MB = 1_000_000
GO_ON_SPARE = 1.25
"""A recording that had no room goes on with so many times the free space that stops it."""
COUNT_S = 5.0
"""The files of other recordings are counted after this time again."""


@dataclass(frozen=True)
class Disk:
    """The folder to write to, and the limits on its files."""

    folder: Path
    """One for this recording alone; others are beside it."""
    most_bytes: int = 256 * MB
    """The largest size of one file."""
    spare_bytes: int = 100 * MB
    """Free space that is left to others."""
    total_bytes: int | None = None
    """The size that all recordings together may reach; None for no limit."""
    when_full: WhenFull = WhenFull.END


class Room:
    """Looks whether there is room for what a bag will write, on the thread that writes it."""

    def __init__(
        self, disk: Disk, bag: Bag, clock: Clock, free_bytes: Callable[[Path], int]
    ) -> None:
        self._disk = disk
        self._bag = bag
        self._clock = clock
        self._free_bytes = free_bytes
        self._others_bytes = 0
        self._count_at_s = 0.0
        self._removed_until_s = 0.0
        self.free_bytes = 0
        """Free space on the disk, at the last look."""

    @property
    def used_bytes(self) -> int:
        """The bytes of all recordings, at the last look and with what was written since."""
        return self._others_bytes + self._bag.size

    @property
    def over(self) -> bool:
        """Whether the recordings have all that they may have."""
        most = self._disk.total_bytes
        return most is not None and self.used_bytes >= most

    def find(self, *, stopped: bool = False) -> str:
        """Make room, if that is asked for; the reason why there is none, else empty.

        A recording that is `stopped` already needs more room than one that runs, and gives up none
        of its files for it: others fill the disk, so the next file would go the same way at once.
        Raises `OSError`.
        """
        ring = self._disk.when_full is WhenFull.RING
        self._look()
        while ring and self.over and self._remove_oldest():
            self._look()
        if self._disk.when_full is not WhenFull.END and self.over:
            most = self._disk.total_bytes or 0
            return f"recordings have {self.used_bytes // MB} MB, and may have {most // MB} MB"
        spare = round(self._disk.spare_bytes * (GO_ON_SPARE if stopped else 1.0))
        if self.free_bytes < spare and not (ring and not stopped and self._spare_one()):
            left = self.free_bytes // MB
            return f"the disk is full: {left} MB are left, {spare // MB} MB are needed"
        return ""

    def _look(self) -> None:
        now_s = self._clock.now()
        if now_s >= self._count_at_s:
            self._others_bytes = used_bytes(self._disk.folder.parent) - self._bag.size
            self._count_at_s = now_s + COUNT_S
        self.free_bytes = self._free_bytes(self._disk.folder)

    def _spare_one(self) -> bool:
        """Remove one file every few seconds: a disk may take a while to tell that it has room."""
        now_s = self._clock.now()
        if now_s < self._removed_until_s:
            return True
        if not self._remove_oldest():
            return False
        self._removed_until_s = now_s + COUNT_S
        return True

    def _remove_oldest(self) -> bool:
        """Remove the oldest file that may go, of others' recordings first; False without any."""
        self._count_at_s = 0.0
        own = self._bag.folder
        for folder in folders(self._disk.folder.parent):
            if folder == own or not removable(folder):
                continue
            with held(folder) as ours:
                if ours and not opened(folder):
                    return _tell(removable(folder)[0], remove)
        return any(_tell(file, self._bag.remove) for file in finished(own)[:1])


def _tell(file: Path, remove_it: Callable[[Path], None]) -> bool:
    size = size_bytes(file)
    remove_it(file)
    log.info("recording_removed", file=file.name, bytes=size)
    return True


MOST_MESSAGES = 20_000
MOST_BYTES = 64 * 1024 * 1024


class WriteQueue:
    """A queue between the receiving and the writing thread; neither waits for the other."""

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


FLUSH_S = 0.4
"""A message older than this, and a moment, is in the file."""
RETRY_S = 5.0
FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
"""The file can go on as soon as there is room. After any other error it is left as it is."""


class Writing:
    """Writes messages from `start` to `close`. While the disk fails, messages are dropped.

    `fault` is the reason why nothing is written at the moment, else empty. The thread looks for
    messages every `flush_s`, and tries again `retry_s` after a fault. Raises `OSError` if the
    folder cannot be made.
    """

    def __init__(
        self,
        inbox: WriteQueue,
        disk: Disk,
        *,
        clock: Clock | None = None,
        free_bytes: Callable[[Path], int] = lambda folder: shutil.disk_usage(folder).free,
        flush_s: float = FLUSH_S,
        retry_s: float = RETRY_S,
    ) -> None:
        self._inbox = inbox
        self._disk = disk
        self._clock = clock or SystemClock()
        self._flush_s = flush_s
        self._retry_s = retry_s
        self._retry_at_s = 0.0
        self.bag = Bag(disk.folder, disk.most_bytes)
        self.room = Room(disk, self.bag, self._clock, free_bytes)
        self.fault = ""
        self.full = threading.Event()
        """Set once recordings that are to `END` then have all the bytes that they may have.

        It goes on until it is closed.
        """
        self.written = 0
        self._held: list[RecordedMessage] = []
        """Messages that the bag has, and the disk has not taken yet."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._work, name="edgevox-recording")

    @property
    def alive(self) -> bool:
        """Whether its thread runs; also True before it is started and after it is closed."""
        return self._closing.is_set() or self._thread.ident is None or self._thread.is_alive()

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Write what is left and end the file."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> None:
        while not self._closing.wait(self._flush_s):
            self.look()
        self._retry_at_s = 0.0  # there is no later
        self.look()
        if not self._try(lambda: self.bag.end_file(self._notes())):
            self._lose_file()
        self._try(self.bag.close)

    def look(self) -> None:
        """Write the messages since the last look, after those that could not be written before.

        Its thread does; a test that turns the clock does it instead of `start`.
        """
        messages = self._inbox.take()
        if not (self._may_write() and self._try(self._catch_up)):
            if messages:
                self._inbox.drop(messages, self.fault)
            return
        self._held = messages
        if self._try(lambda: self.bag.write(messages, self._notes())):
            self._wrote()
            if self.fault:
                log.warning("recording_goes_on")
                self.fault = ""

    def _catch_up(self) -> None:
        self.bag.catch_up(self._notes())
        self._wrote()

    def _wrote(self) -> None:
        self.written += len(self._held)
        self._held = []
        if self._disk.when_full is WhenFull.END and self.room.over:
            self.full.set()

    def _lose_file(self) -> None:
        self.bag.lose_file()
        held, self._held = self._held, []
        if held:
            self._inbox.drop(held, self.fault)

    def _may_write(self) -> bool:
        if self.fault and self._clock.now() < self._retry_at_s:
            return False
        try:
            why = self.room.find(stopped=bool(self.fault))
        except OSError as error:
            self._stop(str(error))
            return False
        if why:
            if not self.fault:
                self._try(lambda: self.bag.end_file(self._notes()))
            self._stop(why)
            return False
        return True

    def _try(self, write: Callable[[], None]) -> bool:
        try:
            write()
        except OSError as error:
            self._stop(f"{self._disk.folder}: {error.strerror or error}")
            if error.errno not in FULL:
                self._lose_file()
            return False
        except Exception as error:  # what is heard later may still be written
            log.exception("recording_file_lost")
            self._stop(repr(error))
            self._lose_file()
            return False
        return True

    def _stop(self, why: str) -> None:
        if not self.fault:
            log.error("recording_stopped", reason=why, retry_s=self._retry_s)
        self.fault = why
        self._retry_at_s = self._clock.now() + self._retry_s

    def _notes(self) -> dict[str, str]:
        return {f"dropped {name}": str(count) for name, count in self._inbox.dropped.items()}
