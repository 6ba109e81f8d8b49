"""The recorder: a node beside the robot that stores the contract's topics as MCAP files.

`recorded_topics` lists the topics, `node` hears them, `disk` queues and writes them into the room
that there is; `mcap` and `metadata` are the format, `mend` ends what a kill left open;
`topic_harness` plays a scenario on a robot over its topics. Imports core, scenario and ros2.
"""

from edgevox.ros2.recorder.disk import Disk
from edgevox.ros2.recorder.mend import mend_recordings
from edgevox.ros2.recorder.node import Recorder
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.ros2.recorder.topic_harness import TopicHarness

__all__ = ["Disk", "Recorder", "TopicHarness", "choose_topics", "mend_recordings"]
