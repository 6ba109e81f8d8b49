"""Which agents share a namespace, and which one of them moves the robot.

Two agents on one namespace hear the same sentences and have nodes of the same name; without a rule
both would drive. `claim` is what each says of itself, `members` the list of those who are here,
with the rule, `sharing` the topics. No clock is compared and the graph is not asked: it shows a
process that was killed for another 20 s.
"""

from edgevox.ros2.presence.sharing import Presence

__all__ = ["Presence"]
