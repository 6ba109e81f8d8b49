"""The recorder: a node beside the robot that keeps what is on the contract's topics, as MCAP files.

`topics` says what, `node` hears it, `inbox` holds it for a moment, `writing` takes it to the disk,
`bag`, `mcap_file`, `definitions` and `metadata` are the format; `stage` lets a scenario play on a
robot that is only known by its topics. Imports core, scenario, ops and ros2.
"""

from edgevox.ros2.recorder.node import Recorder
from edgevox.ros2.recorder.stage import RobotStage
from edgevox.ros2.recorder.topics import choose_topics
from edgevox.ros2.recorder.writing import Disk

__all__ = ["Disk", "Recorder", "RobotStage", "choose_topics"]
