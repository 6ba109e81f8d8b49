"""The agents that share a namespace, and the one of them that moves the robot.

Two agents on one namespace hear the same sentences and have nodes of the same name; without a rule
both would drive. Each agent publishes a `Claim`; `Members` lists the agents present and holds the
rule; `Presence` serves the topics. No clocks are compared, and the graph is not used: it shows a
killed process for another 20 s.
"""

from edgevox.ros2.presence.sharing import Presence

__all__ = ["Presence"]
