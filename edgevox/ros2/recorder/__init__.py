"""The recorder: a node beside the robot that keeps what is on the contract's topics, as MCAP files.

`recorded_topics` says what, `recorder_node` hears it, `write_queue` holds it for a moment,
`writing` takes it to the disk, `bag`, `mcap_file`, `definitions` and `metadata` are the format;
`topic_harness` lets a scenario play on a robot that is only known by its topics. Imports core,
scenario and ros2.
"""

from edgevox.ros2.recorder.disk import Disk
from edgevox.ros2.recorder.node import Recorder
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.ros2.recorder.topic_harness import TopicHarness

__all__ = ["Disk", "Recorder", "TopicHarness", "choose_topics"]
