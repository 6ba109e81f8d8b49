"""What is in a recording while it is written."""

import struct
import time

from mcap import records
from mcap.exceptions import EndOfFile
from mcap.stream_reader import StreamReader
from waiting import wait_until


def texts_of(path):
    """The strings in a file that may have no end, by topic."""
    channels, found = {}, {}
    try:
        with path.open("rb") as stream:
            for record in StreamReader(stream).records:
                if isinstance(record, records.Channel):
                    channels[record.id] = record.topic
                elif isinstance(record, records.Message):
                    text = record.data[8:].rstrip(b"\0").decode("utf-8", "replace")
                    found.setdefault(channels[record.channel_id], []).append(
                        (record.log_time, text)
                    )
    except (EndOfFile, struct.error):
        pass
    return found


def until_recorded(robot, files, topics):
    """Ask until what the robot and this peer say is in one of the files: discovery is not at once.

    files: tells the paths of what is recorded so far.
    """
    wanted = {robot.name(topic) for topic in (*topics, "text_input", "robot_state")}
    asked_s = 0.0

    def recorded():
        nonlocal asked_s
        if time.monotonic() - asked_s > 1.0:
            asked_s = time.monotonic()
            robot.send("text_input", "where are you")
        return any(wanted <= set(texts_of(file)) for file in files())

    wait_until(recorded, f"{wanted} in the file")
